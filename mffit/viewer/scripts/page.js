// The program of a page with curves: the data that the page carries decide what it shows.
import {content} from "./content.js";
import {showFiles} from "./files.js";
import {beginProject} from "./project.js";

if (content.tyres) showFiles(); else beginProject(content.project);
