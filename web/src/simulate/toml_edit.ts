// Changes one number of a robot file's text and leaves all else as it is.

const escaped = (s: string) => s.replace(/[.*+?^${}()|[\]\\]/g, '\\$&');

/// `text` with [table] key = value; the value is TOML. Null where the table cannot be found.
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
