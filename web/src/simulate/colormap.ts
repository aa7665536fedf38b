// Colour maps of fields. Lightness increases evenly in all but the diverging one.
type Stop = readonly [number, number, number];

/// The first is that of src/presentation/draw/colour.cpp; cividis suits people with red-green colour blindness
/// (Nuñez, Anderton and Renslow 2018, in nine stops); blue to red has its centre in the middle of the range.
export const maps: Record<string, { label: string; stops: readonly Stop[] }> = {
  pliant: {
    label: 'Violet to yellow',
    stops: [[0.267, 0.004, 0.329], [0.271, 0.2, 0.475], [0.2, 0.38, 0.545], [0.137, 0.545, 0.553], [0.2, 0.698, 0.486], [0.502, 0.82, 0.31], [0.992, 0.906, 0.145]],
  },
  cividis: {
    label: 'Cividis',
    stops: [[0, 0.135, 0.305], [0.115, 0.226, 0.434], [0.266, 0.308, 0.424], [0.376, 0.4, 0.431], [0.483, 0.482, 0.47], [0.602, 0.572, 0.464], [0.727, 0.666, 0.436], [0.862, 0.773, 0.369], [0.995, 0.909, 0.218]],
  },
  diverging: {
    label: 'Blue to red',
    stops: [[0.13, 0.29, 0.55], [0.36, 0.55, 0.77], [0.68, 0.8, 0.89], [0.93, 0.93, 0.92], [0.94, 0.74, 0.64], [0.84, 0.45, 0.35], [0.61, 0.12, 0.16]],
  },
  grey: { label: 'Grey', stops: [[0.12, 0.12, 0.13], [0.94, 0.94, 0.93]] },
};

/// Rounded to the centre of one of `bands` bands; 0: unchanged.
const banded = (t: number, bands: number) => (bands > 0 ? (Math.min(Math.floor(t * bands), bands - 1) + 0.5) / bands : t);

/// sRGB in [0, 1] for a value in [0, 1].
export function fieldColour(t: number, map = 'pliant', bands = 0): [number, number, number] {
  const stops = (maps[map] ?? maps.pliant).stops;
  const x = banded(Math.min(Math.max(Number.isFinite(t) ? t : 0, 0), 1), bands) * (stops.length - 1);
  const k = Math.min(Math.floor(x), stops.length - 2);
  const s = x - k;
  const mix = (i: number) => stops[k][i] * (1 - s) + stops[k + 1][i] * s;
  return [mix(0), mix(1), mix(2)];
}

export function gradientCss(map = 'pliant', bands = 0, way = 'to top'): string {
  const css = (t: number) => `rgb(${fieldColour(t, map, bands).map((v) => Math.round(255 * v)).join(' ')})`;
  const parts = bands > 0 ? Array.from({ length: bands }, (_, b) => `${css((b + 0.5) / bands)} ${(100 * b) / bands}% ${(100 * (b + 1)) / bands}%`) : Array.from({ length: 13 }, (_, i) => `${css(i / 12)} ${(100 * i) / 12}%`);
  return `linear-gradient(${way}, ${parts.join(', ')})`;
}
