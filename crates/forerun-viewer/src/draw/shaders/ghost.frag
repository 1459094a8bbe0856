// A body that is not there yet: its outline more than its sides.

uniform vec3 eye;
uniform float opacity;

in vec3 point;
in vec3 facing;
in vec4 paint;
flat in float mark;

layout (location = 0) out vec4 colour;

void main() {
    vec3 toEye = normalize(eye - point);
    float front = abs(dot(normalize(facing), toEye));
    float edge = 1.0 - front;
    vec3 lit = paint.rgb * (0.72 + 0.28 * front);
    colour = vec4(mix(lit, vec3(1.0), 0.25 * edge), opacity * paint.a * (0.55 + 0.45 * edge * edge));
}
