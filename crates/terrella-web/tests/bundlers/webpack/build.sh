npx webpack ./main.js --mode production
