// Animated GIF from canvas pictures: one palette for all of them, and only the changed pixels of each. Format:
// CompuServe's GIF89a specification.

export interface Picture {
  data: Uint8ClampedArray; // RGBA
}

const colours = 255; // one of 256 means that a pixel has not changed
const unchanged = 255;

/// 5 bits each of red, green and blue.
const cellOf = (r: number, g: number, b: number) => ((r >> 3) << 10) | ((g >> 3) << 5) | (b >> 3);

interface Box {
  cells: number[];
  pixels: number;
}

/// Red, green or blue component of a cell.
const part = (cell: number, axis: number) => (cell >> (10 - 5 * axis)) & 31;

function widest(box: Box): { axis: number; width: number } {
  let best = { axis: 0, width: -1 };
  for (let axis = 0; axis < 3; ++axis) {
    let [low, high] = [31, 0];
    for (const cell of box.cells) {
      const v = part(cell, axis);
      if (v < low) low = v;
      if (v > high) high = v;
    }
    if (high - low > best.width) best = { axis, width: high - low };
  }
  return best;
}

/// Splits a box into halves of equal pixel count, along its widest colour axis.
function halves(box: Box, counts: Uint32Array): [Box, Box] {
  const { axis } = widest(box);
  const cells = box.cells.slice().sort((a, b) => part(a, axis) - part(b, axis));
  let [k, pixels] = [0, 0];
  while (k < cells.length - 1 && (k === 0 || pixels + counts[cells[k]] <= box.pixels / 2)) pixels += counts[cells[k++]];
  return [
    { cells: cells.slice(0, k), pixels },
    { cells: cells.slice(k), pixels: box.pixels - pixels },
  ];
}

/// Median cut (Heckbert 1982) over all pictures: the colours, and the index for each cell of the colour cube.
function palette(pictures: Picture[]): { table: Uint8Array; of: Uint8Array } {
  const counts = new Uint32Array(32768);
  const sums = [0, 1, 2].map(() => new Float64Array(32768));
  for (const { data } of pictures)
    for (let i = 0; i < data.length; i += 4) {
      const cell = cellOf(data[i], data[i + 1], data[i + 2]);
      counts[cell] += 1;
      for (let c = 0; c < 3; ++c) sums[c][cell] += data[i + c];
    }
  const used = Array.from(counts.keys()).filter((cell) => counts[cell] > 0);
  const boxes: Box[] = [{ cells: used, pixels: used.reduce((n, cell) => n + counts[cell], 0) }];
  while (boxes.length < colours) {
    // Boxes with many pixels and a wide colour range are split first.
    let [best, most] = [-1, 0];
    boxes.forEach((box, k) => {
      const weight = box.cells.length > 1 ? Math.sqrt(box.pixels) * widest(box).width : 0;
      if (weight > most) [best, most] = [k, weight];
    });
    if (best < 0) break;
    boxes.push(...halves(boxes.splice(best, 1)[0], counts));
  }
  const table = new Uint8Array(3 * 256);
  const of = new Uint8Array(32768);
  boxes.forEach((box, k) => {
    for (let c = 0; c < 3; ++c) table[3 * k + c] = Math.round(box.cells.reduce((sum, cell) => sum + sums[c][cell], 0) / Math.max(box.pixels, 1));
    for (const cell of box.cells) of[cell] = k;
  });
  return { table, of };
}

/// A growing byte buffer.
class Bytes {
  private bytes = new Uint8Array(1 << 16);
  private length = 0;
  byte(v: number) {
    if (this.length === this.bytes.length) {
      const larger = new Uint8Array(2 * this.length);
      larger.set(this.bytes);
      this.bytes = larger;
    }
    this.bytes[this.length++] = v;
  }
  short(v: number) {
    this.byte(v & 255);
    this.byte(v >> 8);
  }
  all(values: ArrayLike<number>) {
    for (let i = 0; i < values.length; ++i) this.byte(values[i]);
  }
  text(s: string) {
    for (const c of s) this.byte(c.charCodeAt(0));
  }
  done(): Uint8Array {
    return this.bytes.slice(0, this.length);
  }
}

const clear = 256;
const end = 257;

/// Writes LZW codes as bits, in blocks of up to 255 bytes.
function writeImage(out: Bytes, pixels: Uint8Array) {
  out.byte(8);
  let block: number[] = [];
  let [bits, held] = [0, 0];
  const flush = () => {
    if (block.length === 0) return;
    out.byte(block.length);
    out.all(block);
    block = [];
  };
  const code = (word: number, width: number) => {
    held |= word << bits;
    bits += width;
    while (bits >= 8) {
      block.push(held & 255);
      if (block.length === 255) flush();
      held >>>= 8;
      bits -= 8;
    }
  };
  const known = new Int16Array(4096 * 256);
  let [next, width] = [end + 1, 9];
  code(clear, width);
  let word = pixels[0];
  for (let i = 1; i < pixels.length; ++i) {
    const at = word * 256 + pixels[i];
    if (known[at] > 0) {
      word = known[at];
      continue;
    }
    code(word, width);
    if (next < 4096) {
      known[at] = next;
      if (next === 1 << width && width < 12) width += 1;
      next += 1;
    } else {
      code(clear, width);
      known.fill(0);
      [next, width] = [end + 1, 9];
    }
    word = pixels[i];
  }
  code(word, width);
  code(end, width);
  if (bits > 0) block.push(held & 255);
  flush();
  out.byte(0);
}

/// Loops for ever, with `frame_ms` per picture and `last_ms` for the last one. All of one size; at least one.
export function animatedGif(pictures: Picture[], width: number, height: number, frame_ms: number, last_ms: number): Uint8Array {
  const { table, of } = palette(pictures);
  const out = new Bytes();
  out.text('GIF89a');
  out.short(width);
  out.short(height);
  out.all([0xf7, 0, 0]); // a table of 256 colours of 8 bits
  out.all(table);
  out.all([0x21, 0xff, 11]);
  out.text('NETSCAPE2.0');
  out.all([3, 1, 0, 0, 0]);
  const shown = new Uint8Array(width * height).fill(unchanged);
  pictures.forEach(({ data }, k) => {
    const pixels = new Uint8Array(width * height);
    for (let i = 0; i < pixels.length; ++i) {
      const now = of[cellOf(data[4 * i], data[4 * i + 1], data[4 * i + 2])];
      pixels[i] = now === shown[i] ? unchanged : now;
      shown[i] = now;
    }
    const hundredths = Math.max(2, Math.round((k + 1 === pictures.length ? last_ms : frame_ms) / 10));
    out.all([0x21, 0xf9, 4, 0x05]); // keep the previous picture; one colour is transparent
    out.short(hundredths);
    out.all([unchanged, 0, 0x2c, 0, 0, 0, 0]);
    out.short(width);
    out.short(height);
    out.byte(0);
    writeImage(out, pixels);
  });
  out.byte(0x3b);
  return out.done();
}
