/// "1 layer", "2 layers": a number of things whose plural is the word with an s.
export const counted = (count: number, word: string) => `${count} ${word}${count === 1 ? '' : 's'}`;
