/// "1 layer", "2 layers": a count with its noun; the plural is formed with an s.
export const counted = (count: number, word: string) => `${count} ${word}${count === 1 ? '' : 's'}`;

/// "12.3 ml"; "under 0.1 ml" where that would be 0.0 and is not.
export const millilitres = (ml: number) => (ml > 0 && ml.toFixed(1) === '0.0' ? 'under 0.1 ml' : `${ml.toFixed(1)} ml`);

/// With this number of decimals; what is rounded to 0 has no sign.
export const fixed = (value: number, decimals: number) => value.toFixed(decimals).replace(/^-(?=[0.]*$)/, '');
