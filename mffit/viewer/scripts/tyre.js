// A tyre as functions of the seven inputs, and its curves: one input runs along a curve, the others are fixed.

// Its functions by output, in the code of a use: "on" or "off" for turn slip.
export const compiled = (use, values) =>
  Object.fromEntries(Object.entries(MODELS[use]).map(([name, code]) => [name, code(values)]));
// An output, or an input, in SI as a function of the input that runs along a path {fixed, place, from, to}: the inputs
// in their order, the place among them of the one that runs, and its ends.
export function along(models, {fixed, place}, name, order) {
  const at = fixed.slice(), input = order.indexOf(name), model = models[name];
  return x => {
    at[place] = x;
    return input < 0 ? model(at[0], at[1], at[2], at[3], at[4], at[5], at[6])[name] : at[input];
  };
}
// Numbers x0, y0, x1, ... of a curve {path, x, y, sx, sy}: what is over what, and their units in SI.
export function curvePoints(models, {path, x, y, sx, sy}, steps, order) {
  const X = along(models, path, x, order), Y = along(models, path, y, order), found = new Float64Array(2 * steps + 2);
  for (let k = 0; k <= steps; k++) {
    const at = path.from + (path.to - path.from) * k / steps;
    found[2 * k] = X(at) / sx;
    found[2 * k + 1] = Y(at) / sy;
  }
  return found;
}
