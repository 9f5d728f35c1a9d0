export default {
  optimizeDeps: { exclude: ["terrella"] },
};
