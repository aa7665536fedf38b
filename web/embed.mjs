// Packs every file of a folder with gzip and writes them into one C++ source.
//   node embed.mjs dist page.cpp
import { readFileSync, readdirSync, writeFileSync } from 'node:fs';
import { extname, join } from 'node:path';
import { gzipSync } from 'node:zlib';

const types = {
  '.html': 'text/html; charset=utf-8',
  '.js': 'text/javascript; charset=utf-8',
  '.css': 'text/css; charset=utf-8',
  '.svg': 'image/svg+xml',
  '.txt': 'text/plain; charset=utf-8',
};
const [folder, output] = process.argv.slice(2);

function files(path) {
  return readdirSync(join(folder, path), { withFileTypes: true }).flatMap((entry) =>
    entry.isDirectory() ? files(`${path}/${entry.name}`) : [`${path}/${entry.name}`],
  );
}

// Octal escapes: three digits always, so that no digit behind one belongs to it.
const literal = (bytes) => Array.from(bytes, (b) => '\\' + b.toString(8).padStart(3, '0')).join('');

let text = '// Made by web/embed.mjs.\n#include "studio/built_in/examples.hpp"\n\nnamespace pliant::studio {\n\n';
text += 'std::span<const PageFile> page_files() {\n    using namespace std::string_view_literals;\n';
text += '    static constexpr PageFile files[] = {\n';
let total = 0;
for (const path of files('').sort()) {
  const packed = gzipSync(readFileSync(join(folder, path)), { level: 9 });
  total += packed.length;
  const name = path === '/index.html' ? '/' : path;
  text += `        {"${name}"sv, "${types[extname(path)] ?? 'application/octet-stream'}"sv, "${literal(packed)}"sv, true},\n`;
}
text += '    };\n    return files;\n}\n\n}  // namespace pliant::studio\n';
writeFileSync(output, text);
const limit = 1_200_000;
if (total > limit) {
  console.error(`the page is ${total} bytes packed; ${limit} are allowed`);
  process.exit(1);
}
