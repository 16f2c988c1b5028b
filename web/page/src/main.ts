// The one script of the page. Its workers run the same text, so that the core's JavaScript stands in the file once.

import { begin } from "./app";
import { TALK, talk } from "./talk";
import { work } from "./worker";

if (typeof document !== "undefined") begin();
else if (self.name === TALK) talk();
else work();
