// Light for surfaces in eye space (x right, y up, z towards the viewer), bound to the viewer so that every view of a
// shape reads alike: a key light from the upper left, a weak fill, sky above and ground below, and a rim that parts
// the silhouette from a dark background. Squares and roots stand for the sRGB curve.

vec3 lit(vec3 colour, vec3 normal, vec3 to_viewer, float rim_strength) {
  const vec3 key = vec3(-0.36, 0.48, 0.80), fill = vec3(0.77, -0.15, 0.62);
  float facing = max(dot(normal, to_viewer), 0.0);
  float diffuse = 0.72 * max(dot(normal, key), 0.0) + 0.16 * max(dot(normal, fill), 0.0) +
                  mix(0.05, 0.16, 0.5 + 0.5 * normal.y);
  float half_way = max(dot(normal, normalize(key + to_viewer)), 0.0);
  float half_way_4 = half_way * half_way * half_way * half_way, half_way_16 = half_way_4 * half_way_4 * half_way_4 * half_way_4;
  float shine = 0.10 * half_way_16 * half_way_16 * half_way_16;
  float edge = 1.0 - facing;
  float rim = rim_strength * edge * edge * edge;
  return sqrt(colour * colour * diffuse + vec3(shine) + rim * mix(vec3(0.75, 0.85, 1.0), colour, 0.4));
}

vec3 towards_viewer(vec3 position_eye, mat4 clip_from_eye) {
  bool perspective = clip_from_eye[3][3] == 0.0;
  return perspective ? normalize(-position_eye) : vec3(0.0, 0.0, 1.0);
}
