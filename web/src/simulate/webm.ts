// A WebM file around frames that are encoded as VP8. Format: the WebM container guidelines, an EBML document.

export interface EncodedFrame {
  data: Uint8Array;
  time_ms: number;
  key: boolean;
}

type Part = number[] | Uint8Array;

const text = (s: string) => [...s].map((c) => c.charCodeAt(0));

/// Big-endian, in as many bytes as it takes.
function whole(value: number): number[] {
  const bytes = [];
  do {
    bytes.unshift(value % 256);
    value = Math.floor(value / 256);
  } while (value > 0);
  return bytes;
}

function real(value: number): Uint8Array {
  const view = new DataView(new ArrayBuffer(8));
  view.setFloat64(0, value);
  return new Uint8Array(view.buffer);
}

/// Identifier, size in eight bytes, content.
function element(id: number, ...content: Part[]): Uint8Array {
  const size = content.reduce((sum, part) => sum + part.length, 0);
  const sized = [...whole(id), 0x01, ...Array.from({ length: 7 }, (_, k) => Math.floor(size / 256 ** (6 - k)) % 256)];
  const bytes = new Uint8Array(sized.length + size);
  bytes.set(sized);
  let at = sized.length;
  for (const part of content) {
    bytes.set(part, at);
    at += part.length;
  }
  return bytes;
}

const track = 1;
const longestCluster_ms = 30_000; // times in a cluster have 16 bits, with a sign

function block({ data, time_ms, key }: EncodedFrame, from_ms: number): Uint8Array {
  const after = Math.round(time_ms) - from_ms;
  return element(0xa3, [0x80 | track, after >> 8, after & 255, key ? 0x80 : 0], data);
}

function clusters(frames: EncodedFrame[]): Uint8Array[] {
  const out: Uint8Array[] = [];
  for (let k = 0; k < frames.length; ) {
    const from = Math.round(frames[k].time_ms);
    const blocks: Uint8Array[] = [];
    while (k < frames.length && frames[k].time_ms - from < longestCluster_ms) blocks.push(block(frames[k++], from));
    out.push(element(0x1f43b675, element(0xe7, whole(from)), ...blocks));
  }
  return out;
}

/// In the order of their times; the first one is a key frame.
export function webmFile(frames: EncodedFrame[], width: number, height: number, duration_ms: number): Uint8Array {
  const head = element(0x1a45dfa3, element(0x4286, [1]), element(0x42f7, [1]), element(0x42f2, [4]), element(0x42f3, [8]), element(0x4282, text('webm')), element(0x4287, [2]), element(0x4285, [2]));
  const info = element(0x1549a966, element(0x2ad7b1, whole(1_000_000)), element(0x4489, real(duration_ms)), element(0x4d80, text('Pliant')), element(0x5741, text('Pliant')));
  const video = element(0xe0, element(0xb0, whole(width)), element(0xba, whole(height)));
  const tracks = element(0x1654ae6b, element(0xae, element(0xd7, [track]), element(0x73c5, [track]), element(0x83, [1]), element(0x86, text('V_VP8')), video));
  const segment = element(0x18538067, info, tracks, ...clusters(frames));
  const file = new Uint8Array(head.length + segment.length);
  file.set(head);
  file.set(segment, head.length);
  return file;
}
