// Reads and changes a robot file's text; values are set by the studio (/api/robot/set).

/// The path of a key as for --set: names with dots are put in quotes.
export function keyOf(...parts: string[]): string {
  return parts.map((part) => (/\.|^["']/.test(part) ? `"${part.replace(/["\\]/g, '\\$&')}"` : part)).join('.');
}

/// A change of the robot file by an assignment as for --set, a number with or without a unit, to 6 digits.
export function changeOf(assignment: string): { key: string; value: string | number } {
  const at = assignment.lastIndexOf('=');
  const [, number, unit] = /^"?([^" ]+)(?: ([^"]+))?"?$/.exec(assignment.slice(at + 1)) ?? [];
  const value = +Number(number).toPrecision(6);
  return { key: assignment.slice(0, at), value: unit ? `${value} ${unit}` : value };
}

/// The table at the end of a text: "material" of [material.soft], "cable" of [[cable]], '' at the top.
export function tableAt(before: string): string {
  const headers = [...before.matchAll(/^[ \t]*\[{1,2}\s*([A-Za-z_\x22'][^\],\n]*?)\s*\]{1,2}/gm)];
  const name = headers.at(-1)?.[1] ?? '';
  return name === 'program.key' ? name : name.split('.')[0];
}

/// Numbers under [parameters], which formulas in the file refer to.
export function parametersOf(text: string): { name: string; value: number }[] {
  const list: { name: string; value: number }[] = [];
  let inside = false;
  for (const line of text.split('\n')) {
    const header = /^\s*\[/.test(line);
    if (header) inside = /^\s*\[\s*parameters\s*\]/.test(line);
    const found = !header && inside ? /^\s*([A-Za-z0-9_-]+)\s*=\s*([-+]?[0-9][0-9._]*(?:[eE][-+]?[0-9]+)?)\s*(?:#.*)?$/.exec(line) : null;
    if (found) list.push({ name: found[1], value: Number(found[2].replace(/_/g, '')) });
  }
  return list;
}

/// One piece of a file: whole lines.
interface Piece {
  kind: 'blank' | 'comment' | 'header' | 'key';
  name: string; // of a header or a key, dots without spaces and quotes
  text: string; // without its last line break
}

/// The end of the string that begins at `i`, just behind its quotes.
function endOfString(text: string, i: number): number {
  const quote = text[i];
  const long = text.startsWith(quote.repeat(3), i) ? quote.repeat(3) : quote;
  let at = i + long.length;
  while (at < text.length && !text.startsWith(long, at)) {
    if (long.length === 1 && text[at] === '\n') return at; // not closed: no TOML
    at += quote === '"' && text[at] === '\\' ? 2 : 1;
  }
  at = Math.min(at + long.length, text.length);
  while (long.length === 3 && text[at] === quote && at < text.length) ++at; // """a"""" ends with a quote of its own
  return at;
}

/// The end of the line that the statement at `i` ends on: values may have several lines.
function endOfStatement(text: string, i: number): number {
  let depth = 0;
  for (let at = i; at < text.length; ) {
    const c = text[at];
    if (c === '"' || c === "'") {
      at = endOfString(text, at);
      continue;
    }
    if (c === '#') {
      const end = text.indexOf('\n', at);
      at = end < 0 ? text.length : end;
      continue;
    }
    if (c === '[' || c === '{') ++depth;
    if (c === ']' || c === '}') --depth;
    if (c === '\n' && depth <= 0) return at;
    ++at;
  }
  return text.length;
}

const plainName = (s: string) => s.replace(/\s*\.\s*/g, '.').replace(/["']/g, '').trim();

/// The pieces of a file in order; joined by line breaks they are the file again.
function piecesOf(text: string): Piece[] {
  const pieces: Piece[] = [];
  for (let at = 0; at <= text.length; ) {
    const end = endOfStatement(text, at);
    const piece = text.slice(at, end);
    const header = /^\s*\[\[?([^\]]*)\]/.exec(piece);
    const kind = !piece.trim() ? 'blank' : /^\s*#/.test(piece) ? 'comment' : header ? 'header' : 'key';
    pieces.push({ kind, name: header ? plainName(header[1]) : kind === 'key' ? plainName(piece.split('=')[0]) : '', text: piece });
    at = end + 1;
  }
  return pieces;
}

/// True if a file says itself at which times what is to happen; else its program goes from 0 to 100 %.
export function hasProgramKeys(text: string): boolean {
  let table = '';
  return piecesOf(text).some(({ kind, name }) => {
    if (kind === 'header') table = name;
    return kind === 'header' ? name === 'program.key' : kind === 'key' && (table ? `${table}.${name}` : name) === 'program.key';
  });
}

/// The names of what the keys of a file's program drive.
export function drivenByKeys(text: string): Set<string> {
  const names = new Set<string>();
  const add = (key: string) => {
    const name = key.replace(/^"(.*)"$|^'(.*)'$/, '$1$2').replace(/\\(["\\])/g, '$1');
    if (name && name !== 'time') names.add(name);
  };
  let table = '';
  for (const { kind, name, text: piece } of piecesOf(text)) {
    if (kind === 'header') table = name;
    if (kind !== 'key') continue;
    if (table === 'program.key') add(piece.split('=')[0].trim());
    else if ((table ? `${table}.${name}` : name) === 'program.key')
      for (const [, key] of piece.slice(piece.indexOf('=') + 1).matchAll(/[{,]\s*("(?:[^"\\]|\\.)*"|'[^']*'|[A-Za-z0-9_-]+)\s*=/g)) add(key);
  }
  return names;
}

/// The file with these entries in the place of all entries of a list, such as program.key. Everything else stays,
/// comments on lines of their own too.
export function replaceEntries(text: string, list: string, entries: string): string {
  const kept: Piece[] = [];
  let table = '';
  let place = -1;
  for (const piece of piecesOf(text)) {
    const entry = piece.kind === 'header' && (piece.name === list || piece.name.startsWith(`${list}.`));
    if (piece.kind === 'header') table = piece.name;
    if (entry && place < 0) place = kept.length;
    const inside = table === list || table.startsWith(`${list}.`);
    const inline = piece.kind === 'key' && (table ? `${table}.${piece.name}` : piece.name) === list;
    if (entry || inline || (inside && piece.kind === 'key')) continue;
    if (inside && piece.kind === 'blank' && kept.at(-1)?.kind === 'blank') continue;
    kept.push(piece);
  }
  if (place < 0) place = kept.length;
  const lines = (pieces: Piece[]) => pieces.map((p) => p.text).join('\n');
  const [before, after] = [lines(kept.slice(0, place)).trimEnd(), lines(kept.slice(place)).replace(/^\n+/, '').trimEnd()];
  const gap = kept[place - 1]?.kind === 'comment' ? '\n' : '\n\n';
  return `${before}${before ? gap : ''}${entries}\n${after ? `\n${after}\n` : ''}`;
}
