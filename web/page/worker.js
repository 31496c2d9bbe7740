// The engine in its own thread.
import { instantiate } from "../npm/engine.mjs";
import * as jobs from "./jobs.js";
import { serve } from "./serve.js";

serve(instantiate, jobs);
