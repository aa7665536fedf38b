import { defineConfig } from 'vite';

export default defineConfig({
  esbuild: { jsx: 'automatic', jsxImportSource: 'preact' },
  build: { target: 'es2022', assetsInlineLimit: 0, reportCompressedSize: false, chunkSizeWarningLimit: 2000 },
  // `npm run dev` beside a running `pliant studio --port 7117`
  server: { proxy: { '/api': 'http://127.0.0.1:7117', '/live': { target: 'ws://127.0.0.1:7117', ws: true } } },
});
