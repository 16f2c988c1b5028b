// A scene in the fragment of the address: raw deflate, in the letters of base64 for addresses.

const KEY = "#scene=";

async function through(bytes: Uint8Array<ArrayBuffer>, transform: CompressionStream | DecompressionStream): Promise<Uint8Array<ArrayBuffer>> {
    const stream = new Blob([bytes]).stream().pipeThrough(transform);
    return new Uint8Array(await new Response(stream).arrayBuffer());
}

export function bytesOf(base64: string): Uint8Array<ArrayBuffer> {
    const binary = atob(base64);
    const bytes = new Uint8Array(binary.length);
    for (let at = 0; at < binary.length; at += 1) bytes[at] = binary.charCodeAt(at);
    return bytes;
}

export async function fragmentOf(text: string): Promise<string> {
    const bytes = await through(new TextEncoder().encode(text), new CompressionStream("deflate-raw"));
    let binary = "";
    for (const byte of bytes) binary += String.fromCharCode(byte);
    return KEY + btoa(binary).replaceAll("+", "-").replaceAll("/", "_").replace(/=+$/, "");
}

/** Text in place of the scene of a link that holds none. */
const DAMAGED = "# The link is damaged: it holds no scene. Ask for it again, or choose a scene above.\n";

/** The scene of a fragment; none of another fragment. */
export async function sceneOf(fragment: string): Promise<string | undefined> {
    if (!fragment.startsWith(KEY)) return undefined;
    try {
        const bytes = bytesOf(fragment.slice(KEY.length).replaceAll("-", "+").replaceAll("_", "/"));
        return new TextDecoder().decode(await through(bytes, new DecompressionStream("deflate-raw")));
    } catch {
        return DAMAGED;
    }
}
