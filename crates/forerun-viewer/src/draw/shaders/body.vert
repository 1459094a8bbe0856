// A body: the surface of its shape, stretched, turned and moved.

uniform mat4 viewProjection;

in vec3 position;
in vec3 normal;

// Where it is, and how it is marked.
in vec4 place;
// Quaternion.
in vec4 turn;
in vec4 size;
in uvec4 ink;

out vec3 point;
out vec3 facing;
out vec4 paint;
flat out float mark;

vec3 turned(vec3 v) { return v + 2.0 * cross(turn.xyz, cross(turn.xyz, v) + turn.w * v); }

void main() {
    point = place.xyz + turned(size.xyz * position);
    facing = turned(normal / size.xyz);
    paint = vec4(ink) / 255.0;
    mark = place.w;
    gl_Position = viewProjection * vec4(point, 1.0);
}
