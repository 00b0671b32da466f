// What the program wrote into the page.
import {byId} from "./dom.js";

export const content = JSON.parse(byId("data").textContent);
