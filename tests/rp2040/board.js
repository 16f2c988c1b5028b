// A Raspberry Pi Pico with a flashed image, on rp2040js: pins with their edges, the line, and time in nanoseconds.
"use strict";

const fs = require("node:fs");

const FLASH = 0x1000_0000;
// Behind the second stage, which only sets up a real flash.
const VECTORS = FLASH + 0x100;
const CYCLE_NS = 8;
const LOADED = 1; // PT_LOAD
const SYMBOLS = 2; // SHT_SYMTAB
// At 921,600 baud, 10 bits.
const BYTE_NS = 10_851;
// Exception of USBCTRL_IRQ.
const USB_EXCEPTION = 16 + 5;
const WATCHDOG = 0x40058;
const RESETS = 0x4000c;
const PSM = 0x40010;
const CLOCKS = 0x40008;
// Registers of the frequency counter, and of the watchdog's tick.
const [REFERENCE_KHZ, STATUS, RESULT, TICK] = [0x80, 0x98, 0x9c, 0x2c];
const DONE = 1 << 4;

class Board {
  /** @param library rp2040js  @param image path of the ELF, whose line is a UART; or USB, with a host in `host` */
  constructor(library, image) {
    this.rp = new library.RP2040();
    // Of registers that rp2040js has not, the image needs none.
    this.rp.logger = { debug() {}, info() {}, warn() {}, error() {} };
    this.states = library.GPIOPinState;
    const elf = fs.readFileSync(image);
    for (const { offset, address, length } of segments(elf)) {
      this.rp.flash.set(elf.subarray(offset, offset + length), address - FLASH);
    }
    const { core } = this.rp;
    // rp2040js leaves bit 0 of a vector in the program counter, and then takes wrong ways through tables of jumps.
    const enter = core.exceptionEntry.bind(core);
    core.exceptionEntry = (number) => {
      enter(number);
      core.PC &= ~1;
      // Nor does it forget an interrupt that the program has called, where the controller does not ask for it.
      if (number === USB_EXCEPTION && !this.rp.usbCtrl.intStatus) core.pendingInterrupts &= ~(1 << (USB_EXCEPTION - 16));
    };
    core.VTOR = VECTORS;
    core.SP = this.rp.readUint32(VECTORS);
    core.PC = this.rp.readUint32(VECTORS + 4) & ~1;
    this.edges = this.rp.gpio.map(() => []);
    this.rp.gpio.forEach((pin, index) =>
      pin.addListener((state) => this.edges[index].push({ ns: this.ns, level: this.level(state) })),
    );
    this.toBoard = [];
    this.nextByte = 0;
    this.onByte = () => {};
    this.rp.uart[0].onByte = (byte) => this.onByte(byte);
    this.logged = 0;
    this.rp.uart[1].onByte = () => this.logged++;
    /** Time at which the watchdog has reset the chip, if it has. */
    this.resetNs = undefined;
    /** Host at the USB plug, for an image with that line. */
    this.host = undefined;
    /** Longest time without any interrupt, and lowest address of the stack, once `watches` is set. */
    this.watches = false;
    this.lowestStack = core.SP;
    this.longestMaskedNs = 0;
    this.cycleNs = CYCLE_NS;
    this.countFrequency();
    this.tickByReference();
    /** Address of the function with which the background looks at the line, and the longest time from one look to the next. */
    this.looksAt = symbol(elf, /10background.*8converse/);
    this.lookedNs = undefined;
    this.longestAwayNs = 0;
    this.watchdog.onWatchdogTrigger = () => {
      this.resetNs ??= this.ns;
      // It has bitten. rp2040js would let it bite again at the same time, for ever.
      this.watchdog.timer.enable = false;
    };
  }

  get ns() {
    return this.rp.clock.nanos;
  }

  get watchdog() {
    return this.rp.peripherals[WATCHDOG];
  }

  /** Blocks that the image holds in reset: bits of RESETS. */
  get inReset() {
    return this.rp.peripherals[RESETS].reset;
  }

  /** Parts of the chip that the watchdog resets: bits of PSM_WDSEL. */
  get resetParts() {
    return this.rp.peripherals[PSM].wdsel;
  }

  /** Level that a pin drives: true, false, or undefined where it floats. */
  level(state) {
    return { [this.states.High]: true, [this.states.Low]: false }[state];
  }

  /** The frequency counter, which rp2040js has not: of the crystal, by the reference clock. */
  countFrequency() {
    const clocks = this.rp.peripherals[CLOCKS];
    const [read, write] = [clocks.readUint32.bind(clocks), clocks.writeUint32.bind(clocks)];
    let referenceKhz = 0;
    clocks.readUint32 = (offset) => {
      if (offset === STATUS) return DONE;
      if (offset === RESULT) return Math.round((this.rp.xoscFreq / clocks.refFreq) * referenceKhz) << 5;
      return read(offset);
    };
    clocks.writeUint32 = (offset, value) => {
      if (offset === REFERENCE_KHZ) referenceKhz = value;
      else if (offset < REFERENCE_KHZ) write(offset, value);
    };
  }

  /** The watchdog counts periods of the reference clock; that of rp2040js counts microseconds. */
  tickByReference() {
    const { watchdog } = this;
    const write = watchdog.writeUint32.bind(watchdog);
    watchdog.writeUint32 = (offset, value) => {
      write(offset, value);
      // Twice for each tick (RP2040-E1).
      if (offset === TICK) watchdog.timer.frequency = (2 * this.rp.clocks.refFreq) / (value & 0x1ff);
    };
  }

  /** The crystal stops, and the PLL goes on at a part of its clock. */
  runFree(part) {
    this.rp.xoscFreq /= part;
    this.cycleNs *= part;
    this.rp.updateClocks();
  }

  watch() {
    this.lowestStack = Math.min(this.lowestStack, this.rp.core.SP);
    if (this.rp.core.PM) {
      this.maskedNs ??= this.ns;
    } else if (this.maskedNs !== undefined) {
      this.longestMaskedNs = Math.max(this.longestMaskedNs, this.ns - this.maskedNs);
      this.maskedNs = undefined;
    }
  }

  look() {
    const { ns } = this;
    if (this.watches) this.longestAwayNs = Math.max(this.longestAwayNs, ns - (this.lookedNs ?? ns));
    this.lookedNs = ns;
  }

  /** Runs the board for so long, or until the watchdog resets it. */
  run(ns) {
    const { rp } = this;
    const end = this.ns + ns;
    while (this.ns < end && this.resetNs === undefined) {
      if (this.host) {
        this.host.step();
      } else if (this.toBoard.length && this.ns >= this.nextByte) {
        rp.uart[0].feedByte(this.toBoard.shift());
        this.nextByte = this.ns + BYTE_NS;
      }
      if (rp.core.PC === this.looksAt) this.look();
      rp.clock.tick(rp.core.executeInstruction() * this.cycleNs);
      if (this.watches) this.watch();
    }
  }
}

/** Parts of an ELF that are loaded: place in the file, address in flash, length. */
function segments(elf) {
  const [at, size, count] = [elf.readUInt32LE(28), elf.readUInt16LE(42), elf.readUInt16LE(44)];
  const headers = Array.from({ length: count }, (_, index) => at + index * size);
  return headers
    .filter((header) => elf.readUInt32LE(header) === LOADED)
    .map((header) => ({
      offset: elf.readUInt32LE(header + 4),
      address: elf.readUInt32LE(header + 12),
      length: elf.readUInt32LE(header + 16),
    }))
    .filter(({ length }) => length > 0);
}

/** Address of the function whose symbol matches. */
function symbol(elf, name) {
  const [at, size, count] = [elf.readUInt32LE(32), elf.readUInt16LE(46), elf.readUInt16LE(48)];
  const section = (index) => {
    const header = at + index * size;
    return [4, 16, 20, 24].map((offset) => elf.readUInt32LE(header + offset));
  };
  for (let index = 0; index < count; index++) {
    const [kind, start, length, strings] = section(index);
    if (kind !== SYMBOLS) continue;
    const [, names] = section(strings);
    for (let entry = start; entry < start + length; entry += 16) {
      const from = names + elf.readUInt32LE(entry);
      if (name.test(elf.toString("latin1", from, elf.indexOf(0, from)))) return elf.readUInt32LE(entry + 4) & ~1;
    }
  }
  throw new Error(`no symbol ${name}`);
}

module.exports = { Board };
