// Reads what src/presentation/scene/packet.hpp writes: a JSON head and views into the arrays behind it.

export interface Packet<Head> {
  head: Head;
  f32: (name: string) => Float32Array;
  u32: (name: string) => Uint32Array;
  has: (name: string) => boolean;
}

interface Entry {
  name: string;
  type: 'f32' | 'u32';
  count: number;
}

export function readPacket<Head>(buffer: ArrayBuffer): Packet<Head> {
  const view = new DataView(buffer);
  if (view.getUint32(0, true) !== 0x314e4c50) throw new Error('not a packet of Pliant');
  const length = view.getUint32(4, true);
  const text = new TextDecoder().decode(new Uint8Array(buffer, 8, length));
  const { head, arrays } = JSON.parse(text) as { head: Head; arrays: Entry[] };
  const starts = new Map<string, [number, number]>();
  let at = 8 + length;
  for (const entry of arrays) {
    starts.set(entry.name, [at, entry.count]);
    at += 4 * entry.count;
  }
  const place = (name: string): [number, number] => starts.get(name) ?? [8 + length, 0];
  return {
    head,
    f32: (name) => new Float32Array(buffer, ...place(name)),
    u32: (name) => new Uint32Array(buffer, ...place(name)),
    has: (name) => starts.has(name),
  };
}
