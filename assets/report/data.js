"use strict";
// The model that the page holds: its arrays, and the shapes that they make. Lengths are mm, axes LPS.

const model = (() => {
  const data = JSON.parse(document.getElementById("data").textContent);

  function bytes(text) {
    const letters = atob(text);
    const array = new Uint8Array(letters.length);
    for (let k = 0; k < letters.length; ++k) array[k] = letters.charCodeAt(k);
    return array.buffer;
  }
  const floats = text => new Float32Array(bytes(text));

  const mean = floats(data.mean);
  const modeShapes = floats(data.mode_shapes);
  const coordinates = mean.length;
  const shapes = data.shapes ? floats(data.shapes) : null;
  const cases = data.cases.filter(one => one.in_model);

  /// mean + Σ coefficients[m] · mode m, with coefficients in standard deviations.
  function shapeOf(coefficients, into = new Float32Array(coordinates)) {
    for (let i = 0; i < coordinates; ++i) {
      let sum = mean[i];
      for (let m = 0; m < coefficients.length; ++m) sum += coefficients[m] * modeShapes[m * coordinates + i];
      into[i] = sum;
    }
    return into;
  }

  /// A case as it was aligned, or as the modes make it where the page does not hold it; null where nothing is known.
  function shapeOfCase(index) {
    if (shapes) return shapes.subarray(index * coordinates, (index + 1) * coordinates);
    return cases[index].modes ? shapeOf(cases[index].modes) : null;
  }

  /// Mean of the cases of one group minus mean of those of another; null where one has no shapes.
  function groupDifference(from, to) {
    const meanOf = group => {
      const sum = new Float64Array(coordinates);
      let count = 0;
      cases.forEach((one, index) => {
        const shape = one.group === group ? shapeOfCase(index) : null;
        if (!shape) return;
        ++count;
        for (let i = 0; i < coordinates; ++i) sum[i] += shape[i];
      });
      return count > 0 ? sum.map(value => value / count) : null;
    };
    const a = meanOf(from), b = meanOf(to);
    return a && b ? b.map((value, i) => value - a[i]) : null;
  }

  return {
    version: data.version,
    vertices: data.vertices,
    modes: data.modes,
    variances: data.variances,
    totalVariance: data.variances.reduce((sum, value) => sum + value, 0),
    mean, modeShapes, cases,
    faces: data.face_bytes === 2 ? new Uint16Array(bytes(data.faces)) : new Uint32Array(bytes(data.faces)),
    hues: floats(data.hues),
    glyphs: data.glyphs,
    arrows: data.arrows,
    doubt: data.doubt_mm ? floats(data.doubt_mm) : null,
    groups: data.groups,
    scales: data.scales,
    light: data.light,
    generalisation: data.generalisation_rms,
    specificity: data.specificity_rms,
    measurements: data.measurements || [],
    // The table's row of each case of the model.
    rows: data.cases.map((one, row) => (one.in_model ? row : -1)).filter(row => row >= 0),
    shapeOf, shapeOfCase, groupDifference,
  };
})();

/// One, two or five times a power of ten, and not below the value.
function roundedUp(value) {
  const power = 10 ** Math.floor(Math.log10(Math.max(value, 1e-6)));
  return [1, 2, 5, 10].map(step => step * power).find(step => value <= step * 1.0001) || 10 * power;
}

/// The end of a colour scale: a round number, little above the value.
function scaleEnd(value) {
  const power = 10 ** Math.floor(Math.log10(Math.max(value, 0.01)));
  const step = [1, 1.2, 1.5, 2, 2.5, 3, 4, 5, 6, 8, 10].find(one => value <= one * power * 1.0001) || 10;
  return Number((step * power).toPrecision(3));
}

/// A colour of evenly spaced ones at 0…1.
function onScale(scale, share) {
  const place = Math.min(Math.max(share, 0), 1) * (scale.length - 1);
  const low = Math.min(Math.floor(place), scale.length - 2), t = place - low;
  return [0, 1, 2].map(c => scale[low][c] + t * (scale[low + 1][c] - scale[low][c]));
}

/// As the program's pictures have it: surfaces with saturation 0.4, landmarks with 1.
function hueColour(hue, saturation) {
  return [5, 3, 1].map(n => {
    const k = (n + 6 * hue) % 6;
    return 1 - saturation * Math.max(0, Math.min(k, 4 - k, 1));
  });
}
