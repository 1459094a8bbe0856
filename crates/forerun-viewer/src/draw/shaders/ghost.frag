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
    vec3 lit = paint.rgb * (0.8 + 0.2 * front);
    colour = vec4(mix(lit, vec3(1.0), 0.35 * edge * edge), opacity * paint.a * (0.7 + 0.5 * edge * edge));
}
