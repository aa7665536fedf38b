// The exact states of a result as a curve.

/// Without the approximate states, where the curve has gaps. It goes on over a single one between two exact states: a
/// number that is typed gives one before its exact state, and the curve would be nothing but points.
export function exactCurve(x: number[], y: number[], approximate: boolean[]): { x: number[]; y: number[] } {
  const isBetween = (i: number) => approximate[i] && approximate[i - 1] === false && approximate[i + 1] === false;
  const kept = x.map((_, i) => i).filter((i) => !isBetween(i));
  return { x: kept.map((i) => x[i]), y: kept.map((i) => (approximate[i] ? NaN : y[i])) };
}
