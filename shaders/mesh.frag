uniform mat4 clip_from_eye;
uniform float opacity;
uniform float edge_opacity;

in vec3 position_eye, normal_eye, surface_colour;
out vec4 colour;

void main() {
#ifdef EDGES
  colour = vec4(surface_colour * 0.12, 1.0) * edge_opacity;
#else
  vec3 viewer = towards_viewer(position_eye, clip_from_eye);
  // A vertex whose faces all have no area has no normal.
  vec3 normal = normal_eye * inversesqrt(max(dot(normal_eye, normal_eye), 1e-12));
  // The inside of a surface is greyer and darker, so that a hole or a turned-over face is seen as such.
  vec3 side = gl_FrontFacing ? surface_colour : mix(surface_colour, vec3(0.45), 0.5) * 0.75;
  vec3 shade = lit(side, gl_FrontFacing ? normal : -normal, viewer, 0.14);
  // A thin shell hides more where it is seen at a grazing angle; that keeps the shape of a faint surface readable.
  float facing = max(abs(dot(normal, viewer)), 0.2);
  float alpha = opacity < 1.0 ? min(opacity / facing, 0.5 + 0.5 * opacity) : 1.0;
  colour = vec4(shade, 1.0) * alpha;
#endif
}
