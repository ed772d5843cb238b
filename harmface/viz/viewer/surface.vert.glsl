#version 300 es
// The object, turned, seen by parallel rays along -z, as `frame_orthographic` sees it.

in vec3 position;
in vec3 normal;
in vec3 albedo;
in vec3 carried; // what comes with each vertex: its transfer's result, brute force, or a colour

uniform mat3 object; // rotation of the object
uniform vec3 centre; // of the bounding box, about which it turns
uniform vec2 scale; // from the mesh's unit of length to half the picture
uniform float radius; // of a sphere about the centre that holds the object

out vec3 turnedNormal;
out vec3 paint;
out vec3 brought;

void main() {
    vec3 place = object * (position - centre);
    gl_Position = vec4(place.xy * scale, -place.z / radius, 1.0);
    turnedNormal = object * normal;
    paint = albedo;
    brought = carried;
}
