// Sizes of the canvas in pixels. A browser that imitates a screen of more pixels per point, as developer tools do for a phone, reports
// points for pixels, and the page would be laid out for half the size: points times their pixels then stand in place of that size.

const PROPERTY = "devicePixelContentBoxSize";
const known = Object.getOwnPropertyDescriptor(globalThis.ResizeObserverEntry?.prototype ?? {}, PROPERTY);

/** Size of an entry in pixels by its points. */
function byPoints(points) {
  const pixels = (length) => ({ value: Math.round(length * devicePixelRatio) });
  return Object.create(ResizeObserverSize.prototype, {
    inlineSize: pixels(points.inlineSize),
    blockSize: pixels(points.blockSize),
  });
}

if (known?.get) {
  Object.defineProperty(ResizeObserverEntry.prototype, PROPERTY, {
    ...known,
    get() {
      const sizes = known.get.call(this);
      const pair = sizes.length === 1 && this.contentBoxSize.length === 1;
      if (!pair) return sizes;
      const right = byPoints(this.contentBoxSize[0]);
      // The browser's own pixels differ by rounding only.
      const isNear = Math.abs(sizes[0].inlineSize - right.inlineSize) <= 2 && Math.abs(sizes[0].blockSize - right.blockSize) <= 2;
      return isNear ? sizes : [right];
    },
  });
}
