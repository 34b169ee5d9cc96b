// page_worker.js: the script of a page's worker.
import { answering } from './worker.js';

answering();
