uniform mat4 clip_from_eye;
uniform int disc;  // flat, with a dark rim: in slices
uniform int edge;  // only the soft edge, else only what it encloses

in vec3 on_square_eye;
flat in vec3 centre_eye, glyph_colour;
flat in float radius_mm, pixel_mm;
out vec4 colour;

void main() {
  bool perspective = clip_from_eye[3][3] == 0.0;
  vec3 from = perspective ? vec3(0.0) : vec3(on_square_eye.xy, 0.0);
  vec3 along = perspective ? normalize(on_square_eye) : vec3(0.0, 0.0, -1.0);
  float to_middle_mm = dot(centre_eye - from, along);
  vec3 miss = from + to_middle_mm * along - centre_eye;
  float miss_mm = length(miss);
  float coverage = clamp((radius_mm - miss_mm) / pixel_mm + 0.5, 0.0, 1.0);
  if (coverage == 0.0 || (edge != 0) != (coverage < 1.0)) discard;

  float half_chord_mm = sqrt(max(radius_mm * radius_mm - miss_mm * miss_mm, 0.0));
  vec3 hit = from + (to_middle_mm - half_chord_mm) * along;
  vec4 clip = clip_from_eye * vec4(hit, 1.0);
  gl_FragDepth = clip.z / clip.w * 0.5 + 0.5;

  vec3 shade;
  if (disc != 0) {
    float rim = clamp((radius_mm - miss_mm) / pixel_mm - 0.5, 0.0, 1.0);
    shade = glyph_colour * mix(0.25, 1.0, rim);
  } else {
    shade = lit(glyph_colour, normalize(hit - centre_eye), -along, 0.0);
  }
  colour = vec4(shade, 1.0) * coverage;
}
