// An error of the studio in the words of the form: at which field it is shown, and what helps there. The studio's own
// message names options of the command line.

export interface Wrong {
  option: string;
  value: string;
  text: string;
}

/// Labels in the form of what messages advise.
export const labels = { anyVat: 'Fill resins that no vat holds into free vats', wall: 'Wall thickness' };

/// Null if the message is about no field.
export function wrongOf(message: string): Wrong | null {
  const vat = /^(no vat of .+ holds the resin "(.*)" of ".+": .+) Slice with --resin MATERIAL=RESIN, or with --any-vat /s.exec(message);
  if (vat) return { option: 'resin', value: vat[2], text: `${vat[1]} Choose another resin above, or tick “${labels.anyVat}”.` };
  const match = /^--([a-z-]+)(?: ([^:]*))?: (.*)$/s.exec(message);
  return match && { option: match[1], value: match[2] ?? '', text: match[3].replace('--hollow', `“${labels.wall}”`) };
}
