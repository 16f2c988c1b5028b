"""Consistent overhead byte stuffing: bytes without zeros."""


def encode(data: bytes) -> bytes:
    """``data`` stuffed; the zero that ends a frame is not added."""
    out = bytearray()
    rest = bytes(data) + b"\0"  # the end counts as a zero
    while rest:
        run = rest.find(0)
        if run >= 254:
            out.append(255)
            out += rest[:254]
            rest = rest[254:]
            if rest == b"\0":  # a full block at the very end implies no zero
                break
        else:
            out.append(run + 1)
            out += rest[:run]
            rest = rest[run + 1 :]
    return bytes(out)


def decode(stuffed: bytes) -> bytes:
    """What was stuffed. ``ValueError``: it ends inside a block, or holds a zero."""
    if 0 in stuffed:
        raise ValueError("a zero inside a frame")
    out = bytearray()
    at = 0
    while at < len(stuffed):
        count = stuffed[at]
        block = stuffed[at + 1 : at + count]
        if len(block) != count - 1:
            raise ValueError("the frame ends inside a COBS block")
        out += block
        at += count
        if count < 255 and at < len(stuffed):
            out.append(0)
    return bytes(out)
