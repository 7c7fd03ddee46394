import { svelte } from "@sveltejs/vite-plugin-svelte";
import { defineConfig } from "vitest/config";

const backend = "http://127.0.0.1:8000";

export default defineConfig({
  plugins: [svelte()],
  // The backend serves the built screen as files of its own package.
  build: { outDir: "../backend/screen", emptyOutDir: true, target: "es2022" },
  server: {
    host: "127.0.0.1",
    proxy: { "/api": { target: backend, ws: true }, "/openapi.json": backend },
  },
  test: { environment: "node", include: ["src/**/*.test.ts"] },
});
