// The field colours of src/presentation/draw/colour.cpp: dark violet over teal to yellow, lightness rising evenly.
const stops = [
  [0.267, 0.004, 0.329],
  [0.271, 0.2, 0.475],
  [0.2, 0.38, 0.545],
  [0.137, 0.545, 0.553],
  [0.2, 0.698, 0.486],
  [0.502, 0.82, 0.31],
  [0.992, 0.906, 0.145],
];

/// sRGB in [0, 1] of a value in [0, 1].
export function fieldColour(t: number): [number, number, number] {
  const x = Math.min(Math.max(Number.isFinite(t) ? t : 0, 0), 1) * (stops.length - 1);
  const k = Math.min(Math.floor(x), stops.length - 2);
  const s = x - k;
  const mix = (i: number) => stops[k][i] * (1 - s) + stops[k + 1][i] * s;
  return [mix(0), mix(1), mix(2)];
}

export function gradientCss(): string {
  const list = stops.map((c, i) => `rgb(${c.map((v) => Math.round(255 * v)).join(' ')}) ${(100 * i) / (stops.length - 1)}%`);
  return `linear-gradient(to top, ${list.join(', ')})`;
}
