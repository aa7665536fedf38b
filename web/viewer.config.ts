// The viewer of notebooks as one script: dist_viewer/viewer.js.
import { defineConfig } from 'vite';

export default defineConfig({
  define: { 'process.env.NODE_ENV': '"production"' },
  build: {
    target: 'es2022',
    outDir: 'dist_viewer',
    reportCompressedSize: false,
    lib: { entry: 'src/viewer.ts', formats: ['iife'], name: 'PliantViewer', fileName: () => 'viewer.js' },
  },
});
