// Changes one number in a robot file's text and leaves everything else unchanged.

const escaped = (s: string) => s.replace(/[.*+?^${}()|[\]\\]/g, '\\$&');

/// `text` with [table] key = value; the value is TOML. Null if the table is not found.
export function setKey(text: string, table: string, key: string, value: string): string | null {
  const lines = text.split('\n');
  const name = table.split('.').map((part) => `"?${escaped(part)}"?`).join('\\s*\\.\\s*');
  const header = new RegExp(`^\\s*\\[\\s*${name}\\s*\\]`);
  const begin = lines.findIndex((l) => header.test(l));
  if (begin >= 0) {
    const found = lines.findIndex((l, i) => i > begin && /^\s*\[/.test(l));
    const end = found < 0 ? lines.length : found;
    const own = new RegExp(`^(\\s*${escaped(key)}\\s*=\\s*)("[^"]*"|'[^']*'|\\[[^\\]]*\\]|[^#\\s]+)`);
    for (let i = begin + 1; i < end; ++i) {
      if (!own.test(lines[i])) continue;
      lines[i] = lines[i].replace(own, `$1${value}`);
      return lines.join('\n');
    }
    lines.splice(begin + 1, 0, `${key} = ${value}`);
    return lines.join('\n');
  }
  // material.soft = { youngs_modulus = "1 MPa", ... }
  const inline = new RegExp(`^(\\s*${name}\\s*=\\s*\\{)(.*)(\\}.*)$`);
  const at = lines.findIndex((l) => inline.test(l));
  if (at < 0) return null;
  lines[at] = lines[at].replace(inline, (_, open: string, inner: string, close: string) => {
    const own = new RegExp(`((?:^|,)\\s*${escaped(key)}\\s*=\\s*)("[^"]*"|'[^']*'|\\[[^\\]]*\\]|[^,}\\s]+)`);
    return open + (own.test(inner) ? inner.replace(own, `$1${value}`) : `${inner.trimEnd()}, ${key} = ${value} `) + close;
  });
  return lines.join('\n');
}

/// `text` with "material.soft.youngs_modulus" or "cable.flexor.friction" = value, as for the program's --set: supports
/// tables, inline tables and entries such as [[cable]] by their name. Null if the key's table is not found.
export function assign(text: string, path: string, value: string): string | null {
  const parts = path.split('.');
  for (let k = parts.length - 1; k > 0; --k) {
    const next = setKey(text, parts.slice(0, k).join('.'), parts.slice(k).join('.'), value);
    if (next !== null) return next;
  }
  return parts.length > 2 ? setInEntry(text, parts[0], parts[1], parts.slice(2).join('.'), value) : null;
}

/// In the entry of [[list]] with this name.
function setInEntry(text: string, list: string, name: string, key: string, value: string): string | null {
  const lines = text.split('\n');
  const header = new RegExp(`^\\s*\\[\\[\\s*${escaped(list)}\\s*\\]\\]`);
  const named = new RegExp(`^\\s*name\\s*=\\s*["']${escaped(name)}["']`);
  for (let begin = 0; begin < lines.length; ++begin) {
    if (!header.test(lines[begin])) continue;
    const found = lines.findIndex((l, i) => i > begin && /^\s*\[/.test(l));
    const end = found < 0 ? lines.length : found;
    const at = lines.findIndex((l, i) => i > begin && i < end && named.test(l));
    if (at < 0) continue;
    const own = new RegExp(`^(\\s*${escaped(key)}\\s*=\\s*)("[^"]*"|'[^']*'|[^#\\s]+)`);
    const there = lines.findIndex((l, i) => i > begin && i < end && own.test(l));
    if (there >= 0) lines[there] = lines[there].replace(own, `$1${value}`);
    else lines.splice(at + 1, 0, `${key} = ${value}`);
    return lines.join('\n');
  }
  return null;
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
