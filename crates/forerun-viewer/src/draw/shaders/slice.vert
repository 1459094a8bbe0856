// A rectangle in the world.

uniform mat4 viewProjection;
uniform vec3 middle;
uniform vec3 along;
uniform vec3 beside;

in vec2 corner;

out vec2 spot;

void main() {
    spot = 0.5 + 0.5 * corner;
    gl_Position = viewProjection * vec4(middle + corner.x * along + corner.y * beside, 1.0);
}
