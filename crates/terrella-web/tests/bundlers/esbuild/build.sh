package=node_modules/terrella
npx esbuild main.js $package/worker-webgpu.js $package/worker-webgl.js $package/worker-pack.js --bundle --splitting --format=esm --entry-names=[name] --outdir=dist
cp -R $package/maps $package/data $package/*.wasm dist
