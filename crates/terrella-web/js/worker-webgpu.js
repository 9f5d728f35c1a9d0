// The worker of the WebGPU backend. A worker for each: not all bundlers make workers that import at run time.

import start, { decodeMaps } from "./webgpu.js";
import { decodeMessages } from "./decoding.js";

decodeMessages(start, decodeMaps);
