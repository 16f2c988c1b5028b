// A host at the USB plug of a board on rp2040js: it enumerates the board as a serial port, opens that, and carries bytes at the rate of
// a bus at full speed.
//
// The host of rp2040js takes each packet at once and has an answer for each at once. This one comes in transactions, as a bus does: a
// packet waits in the buffer of the controller until the host comes for it.
"use strict";

const AVAILABLE = 1 << 10;
const STALL = 1 << 11;
const DATA1 = 1 << 13;
const FULL = 1 << 15;
const LENGTH = 0x3ff;
const PULLUP = 1 << 16;
const BUS_RESET = 1 << 19;
const SETUP = 1 << 17;
const SUSPENDED = 1 << 4;
const [SOF_RD, SIE_STATUS] = [0x48, 0x50];
// USBCTRL in RESETS.
const USBCTRL = 1 << 24;
const FRAME_NS = 1e6;
const [OUT, IN] = [0, 1];
const PACKET = 64;
// 64 bytes with head, checksum and handshake at 12 Mbit/s.
const TRANSACTION_NS = 50_000;
// A bus without any transaction is at rest.
const REST_NS = 3e6;
// As long as a host leaves the bus in reset.
const RESET_NS = 10e6;

class UsbHost {
  /** @param board board with `rp`, `toBoard` and `onByte` */
  constructor(board) {
    this.board = board;
    this.usb = board.rp.usbCtrl;
    this.memory = board.rp.usbDPRAMView;
    this.bytes = board.rp.usbDPRAM;
    // A buffer stays available until this host comes.
    this.usb.DPRAMUpdated = () => {};
    // rp2040js does not let the device clear this flag.
    const write = this.usb.writeUint32.bind(this.usb);
    this.usb.writeUint32 = (offset, value) => {
      if (offset === SIE_STATUS && this.usb.rawWriteValue & SUSPENDED) this.usb.sieStatus &= ~SUSPENDED;
      write(offset, value);
    };
    // Nor does it count the frames of a host, or reset the controller.
    const read = this.usb.readUint32.bind(this.usb);
    this.usb.readUint32 = (offset) => (offset === SOF_RD ? this.frame() : read(offset));
    this.nextNs = 0;
    this.plugged = true;
    /** Time since which the controller has hung, and at which the image has reset it. */
    this.hungNs = undefined;
    this.goneNs = undefined;
    this.carries = true;
    /** A program has the port open. */
    this.opens = false;
    /** Packets whose toggle between DATA0 and DATA1 is not its turn. */
    this.wrongToggles = 0;
    this.transactions = this.enumeration();
    /** Content of descriptors, once it is enumerated. */
    this.device = undefined;
    this.configuredNs = undefined;
  }

  /** Pulls the cable. */
  unplug() {
    this.plugged = false;
    this.restNs = this.board.ns + REST_NS;
  }

  /** Puts the cable in again. */
  plugIn() {
    this.plugged = true;
    this.transactions = this.enumeration();
  }

  /** The program that has the port open stops, or goes on: it neither takes nor gives bytes. */
  stop(isStopped) {
    this.carries = !isStopped;
  }

  /** A program on the host opens the port. */
  open() {
    this.opens = true;
    if (!this.transactions) this.transactions = this.setLineState(true);
  }

  /** The controller hears nothing any more. */
  hang() {
    this.hungNs = this.board.ns;
  }

  /** Number of the frame that the controller has heard last. */
  frame() {
    return Math.floor((this.hungNs ?? this.board.ns) / FRAME_NS) & 0x7ff;
  }

  /** One transaction, if it is time for one. */
  step() {
    const { ns } = this.board;
    if (this.hungNs !== undefined) {
      if (!(this.board.inReset & USBCTRL)) return;
      // The device is gone, and comes back with its pull-up.
      this.goneNs = ns;
      this.hungNs = undefined;
      this.usb.sieCtrl &= ~PULLUP;
      this.plugIn();
    }
    if (ns < this.nextNs) return;
    this.nextNs = ns + TRANSACTION_NS;
    if (!this.plugged) {
      if (ns >= this.restNs) {
        this.restNs = Infinity;
        this.raise(SUSPENDED);
      }
      return;
    }
    if (this.transactions) {
      if (this.transactions.next().done) this.transactions = undefined;
      return;
    }
    this.carry();
  }

  /** Bytes in both directions. */
  carry() {
    if (!this.endpoints || !this.carries) return;
    const { toBoard } = this.board;
    const [out, into] = this.endpoints;
    if (toBoard.length && this.isAvailable(out, OUT)) {
      this.put(out, toBoard.splice(0, PACKET));
    }
    if (this.isAvailable(into, IN)) {
      this.take(into).forEach((byte) => this.board.onByte(byte));
    }
  }

  *enumeration() {
    while (!(this.usb.sieCtrl & PULLUP)) yield;
    const end = this.board.ns + RESET_NS;
    while (this.board.ns < end) yield;
    this.raise(BUS_RESET);
    while (this.usb.sieStatus & BUS_RESET) yield;
    this.toggles = {};
    const get = (kind, index, length, language = 0) => this.control([0x80, 6, index, kind, language & 255, language >> 8, length, 0]);
    const device = yield* get(1, 0, 18);
    yield* this.control([0, 5, 7, 0, 0, 0, 0, 0]);
    const [, , low, high] = yield* get(2, 0, 9);
    const configuration = yield* get(2, 0, low | (high << 8));
    const texts = [];
    for (const index of device.slice(14, 17)) {
      const text = index ? yield* get(3, index, 255, 0x409) : [];
      texts.push(Buffer.from(text.slice(2)).toString("utf16le"));
    }
    yield* this.control([0, 9, configuration[5], 0, 0, 0, 0, 0]);
    this.device = {
      vendor: device[8] | (device[9] << 8),
      product: device[10] | (device[11] << 8),
      texts,
      address: this.usb.addrEndp & 0x7f,
    };
    this.endpoints = dataEndpoints(configuration);
    // 115,200 baud, 8 data bits: a host sets a rate, and the board takes none.
    yield* this.control([0x21, 0x20, 0, 0, 0, 0, 7, 0], [0x00, 0xc2, 0x01, 0x00, 0, 0, 8]);
    this.configuredNs = this.board.ns;
    if (this.opens) yield* this.setLineState(true);
  }

  *setLineState(isOpen) {
    // Data terminal ready, request to send.
    yield* this.control([0x21, 0x22, isOpen ? 3 : 0, 0, 0, 0, 0, 0]);
  }

  /** A control transfer: its data, from the device or to it, and its status. Returns the data from the device. */
  *control(setup, data) {
    this.bytes.set(setup, 0);
    this.toggles[0 * 2 + OUT] = this.toggles[0 * 2 + IN] = DATA1;
    this.raise(SETUP);
    yield;
    const length = setup[6] | (setup[7] << 8);
    const isFromDevice = setup[0] & 0x80;
    const received = [];
    if (isFromDevice) {
      let packet;
      do {
        while (!this.isAvailable(0, IN)) yield this.refuse(setup);
        packet = this.take(0);
        received.push(...packet);
        yield;
      } while (packet.length === PACKET && received.length < length);
    } else if (data) {
      while (!this.isAvailable(0, OUT)) yield this.refuse(setup);
      this.put(0, data);
      yield;
    }
    this.toggles[0 * 2 + OUT] = this.toggles[0 * 2 + IN] = DATA1;
    const status = isFromDevice ? OUT : IN;
    while (!this.isAvailable(0, status)) yield this.refuse(setup);
    if (status === OUT) this.put(0, []);
    else this.take(0);
    yield;
    return received;
  }

  /** Ends the bench where the device refuses a request. */
  refuse(setup) {
    if ((this.control_of(0, IN) | this.control_of(0, OUT)) & STALL) throw new Error(`USB: the device refuses ${setup}`);
  }

  raise(flag) {
    this.usb.sieStatus |= flag;
    this.usb.sieStatusUpdated();
  }

  place(endpoint, direction) {
    return 0x80 + endpoint * 8 + (direction === OUT ? 4 : 0);
  }

  control_of(endpoint, direction) {
    return this.memory.getUint32(this.place(endpoint, direction), true);
  }

  /** The device has a packet for the host, or room for one. */
  isAvailable(endpoint, direction) {
    return (this.control_of(endpoint, direction) & AVAILABLE) !== 0;
  }

  buffer(endpoint, direction) {
    if (endpoint === 0) return 0x100;
    return this.memory.getUint32(8 + (endpoint - 1) * 8 + (direction === OUT ? 4 : 0), true) & 0xffc0;
  }

  /** Checks the toggle of a packet, and takes the turn of the next one. */
  toggle(endpoint, direction, control) {
    const index = endpoint * 2 + direction;
    const turn = this.toggles[index] ?? 0;
    if ((control & DATA1) !== turn) this.wrongToggles++;
    this.toggles[index] = turn ^ DATA1;
  }

  /** Takes a packet from the device. */
  take(endpoint) {
    const control = this.control_of(endpoint, IN);
    this.toggle(endpoint, IN, control);
    const at = this.buffer(endpoint, IN);
    const packet = Array.from(this.bytes.subarray(at, at + (control & LENGTH)));
    this.memory.setUint32(this.place(endpoint, IN), control & ~(AVAILABLE | FULL), true);
    this.usb.indicateBufferReady(endpoint, false);
    return packet;
  }

  /** Gives the device a packet. */
  put(endpoint, packet) {
    const control = this.control_of(endpoint, OUT);
    this.toggle(endpoint, OUT, control);
    this.bytes.set(packet, this.buffer(endpoint, OUT));
    const filled = (control & ~(AVAILABLE | LENGTH)) | FULL | packet.length;
    this.memory.setUint32(this.place(endpoint, OUT), filled, true);
    this.usb.indicateBufferReady(endpoint, true);
  }
}

/** Numbers of the endpoints with the bytes of the port, to the device and from it. */
function dataEndpoints(configuration) {
  const numbers = [];
  let isData = false;
  for (let at = 0; at < configuration.length; at += configuration[at]) {
    const [, kind, address] = configuration.slice(at, at + 3);
    if (kind === 4) isData = configuration[at + 5] === 10;
    if (kind === 5 && isData) numbers[address & 0x80 ? IN : OUT] = address & 15;
  }
  return numbers;
}

module.exports = { UsbHost };
