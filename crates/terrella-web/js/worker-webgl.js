// The worker of the WebGL2 backend. A worker for each: not all bundlers make workers that import at run time.

import start, { decodeMaps } from "./webgl.js";
import { decodeMessages } from "./decoding.js";

decodeMessages(start, decodeMaps);
