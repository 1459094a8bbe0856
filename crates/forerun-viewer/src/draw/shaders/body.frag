// What is on this side of the plane `cut` (normal, distance) is taken off bodies marked 3.
uniform vec4 cut;

in vec3 point;
in vec3 facing;
in vec4 paint;
flat in float mark;

layout (location = 0) out vec4 colour;

void main() {
    if (mark > 2.5 && dot(cut.xyz, point) > cut.w) { discard; }
    vec3 toEye = normalize(eye - point);
    vec3 normal = normalize(facing);
    // Both sides are drawn: open meshes have no other.
    if (dot(normal, toEye) < 0.0) { normal = -normal; }
    vec3 albedo = linearOf(paint.rgb);
    if (mark > 0.5) { albedo = mix(albedo, vec3(1.0), 0.22); }
    vec3 light = lightOn(point, normal, toEye);
    float shine = pow(max(dot(normal, normalize(toEye + toSun)), 0.0), 36.0);
    float edge = pow(1.0 - max(dot(normal, toEye), 0.0), 4.0);
    vec3 seen = albedo * light + sun * (0.10 * shine) + fromSky * (0.10 * edge);
    colour = vec4(screen(hazed(seen, point)), 1.0);
}
