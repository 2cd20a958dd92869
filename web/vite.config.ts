import vue from "@vitejs/plugin-vue";
import { defineConfig } from "vite";

// The service serves what is built into dist/. During work on the page, `npm run dev` takes data from a running service.
const SERVICE = process.env.PSLV_SERVICE ?? "http://127.0.0.1:8000";
const PATHS = ["/api", "/live", "/view3d", "/healthz", "/readyz", "/metrics", "/docs", "/openapi.json"];

export default defineConfig({
  plugins: [vue()],
  base: "/web/",
  build: { outDir: "dist", emptyOutDir: true, assetsInlineLimit: 0, chunkSizeWarningLimit: 600 },
  server: { proxy: Object.fromEntries(PATHS.map((path) => [path, { target: SERVICE, ws: true }])) },
  test: { include: ["src/**/*.test.ts"] },
} as Parameters<typeof defineConfig>[0]);
