// The one script of the page. Its worker runs the same text, so that the core's JavaScript stands in the file once.

import { begin } from "./app";
import { work } from "./worker";

if (typeof document === "undefined") work();
else begin();
