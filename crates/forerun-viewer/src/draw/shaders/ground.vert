// A half-space: its plane, as far as one sees.

uniform mat4 viewProjection;
uniform vec3 middle;
uniform vec3 along;
uniform vec3 beside;
// From the middle of the plane's own grid, so that lines far out stay sharp. Metres.
uniform vec2 shift;
uniform float reach;

in vec2 corner;

out vec3 point;
out vec2 place;

void main() {
    point = middle + reach * (corner.x * along + corner.y * beside);
    place = shift + reach * corner;
    gl_Position = viewProjection * vec4(point, 1.0);
}
