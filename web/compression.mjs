// The settings of the compressed copies, which web/pack.mjs writes and tests/browser/weigh.mjs weighs.

import { constants } from "node:zlib";

const { BROTLI_PARAM_QUALITY, BROTLI_PARAM_LGWIN, BROTLI_PARAM_SIZE_HINT } = constants;

export const GZIP = { level: 9 };

/** The settings of brotli for a content. */
export const brotliOf = ({ length }) => ({
  params: { [BROTLI_PARAM_QUALITY]: 11, [BROTLI_PARAM_LGWIN]: 24, [BROTLI_PARAM_SIZE_HINT]: length },
});
