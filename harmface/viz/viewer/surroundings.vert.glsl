#version 300 es
// One triangle that covers the viewport.

out vec2 place; // from -1 at the left and at the bottom to 1

void main() {
    place = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);
    gl_Position = vec4(place, 0.0, 1.0);
}
