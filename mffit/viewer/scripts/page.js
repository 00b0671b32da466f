// The page of a project without a window.
import {content} from "./content.js";
import {begin} from "./project.js";

begin(content.project);
