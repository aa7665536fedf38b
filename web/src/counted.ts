/// "1 layer", "2 layers": a count with its noun; the plural is formed with an s.
export const counted = (count: number, word: string) => `${count} ${word}${count === 1 ? '' : 's'}`;
