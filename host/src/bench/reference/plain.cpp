// A plain path tracer in double precision: what the reference's efficiency is measured against.
//
// Kajiya's walk backwards from the camera, with one random choice a surface. It meets light and never looks for it, and no two of its random
// numbers have to do with each other. What a scene means is in scenes/README.md; plain.rs beside this file writes one down in numbers, and
// reads the answer.
//
//     plain SCENE WIDTH HEIGHT SAMPLES SEED
//
// SAMPLES are those of each of a pixel's 2x2 sub-pixels. The answer is the time of rendering alone, then a line for each sub-pixel of each
// pixel: the sums of its samples, then those of their squares.

#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <vector>

namespace {

struct Vector {
    double x, y, z;
};

Vector operator+(const Vector &a, const Vector &b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
Vector operator-(const Vector &a, const Vector &b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
Vector operator*(const Vector &a, double factor) { return {a.x * factor, a.y * factor, a.z * factor}; }
Vector times(const Vector &a, const Vector &b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }
double dot(const Vector &a, const Vector &b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
Vector cross(const Vector &a, const Vector &b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
Vector normalised(const Vector &a) { return a * (1.0 / std::sqrt(dot(a, a))); }

// Xoshiro256++ (Blackman and Vigna 2019), its state filled by SplitMix64, as they advise.
class Random {
  public:
    explicit Random(std::uint64_t seed) {
        for (auto &word : state) {
            seed += 0x9e3779b97f4a7c15;
            std::uint64_t mixed = (seed ^ (seed >> 30)) * 0xbf58476d1ce4e5b9;
            mixed = (mixed ^ (mixed >> 27)) * 0x94d049bb133111eb;
            word = mixed ^ (mixed >> 31);
        }
    }

    // Uniform in [0, 1).
    double uniform() {
        const std::uint64_t next = rotated(state[0] + state[3], 23) + state[0];
        const std::uint64_t shifted = state[1] << 17;
        state[2] ^= state[0];
        state[3] ^= state[1];
        state[1] ^= state[2];
        state[0] ^= state[3];
        state[2] ^= shifted;
        state[3] = rotated(state[3], 45);
        return static_cast<double>(next >> 11) * 0x1p-53;
    }

  private:
    static std::uint64_t rotated(std::uint64_t word, int by) { return (word << by) | (word >> (64 - by)); }

    std::uint64_t state[4];
};

enum Kind { DIFFUSE, MIRROR, GLASS };

struct Sphere {
    Vector centre;
    double square;
    // Rays are always inside, so that the near crossing is never a surface.
    bool hollow;
};

struct Surface {
    Vector centre, emission, colour;
    double strongest, index;
    Kind kind;
};

struct Camera {
    Vector position, direction, across, upwards;
    double near;
};

struct Scene {
    Camera camera;
    std::vector<Sphere> spheres;
    std::vector<Surface> surfaces;
};

struct Ray {
    Vector origin, direction;
};

constexpr int NONE = -1;

// The first sphere that a ray meets, and how far away. The one that it leaves is known by its number: no distance is too small to be a hit.
int first_hit(const Scene &scene, const Ray &ray, int departed, double &nearest) {
    int which = NONE;
    const int count = static_cast<int>(scene.spheres.size());
    for (int number = 0; number < count; ++number) {
        const Sphere &sphere = scene.spheres[number];
        const Vector to_centre = sphere.centre - ray.origin;
        const double along = dot(to_centre, ray.direction);
        double distance;
        if (number == departed) {
            // The other end of a chord. It is behind rays that leave a solid.
            distance = 2.0 * along;
        } else {
            const double square = along * along - dot(to_centre, to_centre) + sphere.square;
            if (square < 0.0) {
                continue;
            }
            const double half_chord = std::sqrt(square);
            distance = along - half_chord;
            if (sphere.hollow || distance <= 0.0) {
                distance = along + half_chord;
            }
        }
        if (distance > 0.0 && distance < nearest) {
            nearest = distance;
            which = number;
        }
    }
    return which;
}

// A direction around `normal` with a density that goes with its cosine.
Vector diffused(const Vector &normal, Random &random) {
    const double around = 2.0 * M_PI * random.uniform();
    const double square = random.uniform();
    const Vector helper = std::fabs(normal.x) > 0.1 ? Vector{0.0, 1.0, 0.0} : Vector{1.0, 0.0, 0.0};
    const Vector tangent = normalised(cross(helper, normal));
    const Vector bitangent = cross(normal, tangent);
    const double sine = std::sqrt(square);
    const Vector aside = tangent * (std::cos(around) * sine) + bitangent * (std::sin(around) * sine);
    return normalised(aside + normal * std::sqrt(1.0 - square));
}

Vector reflected(const Vector &incoming, const Vector &normal) {
    return incoming - normal * (2.0 * dot(normal, incoming));
}

// Through the surface or back from it, each with the chance of its share of light (Schlick 1994).
Vector through_glass(const Vector &incoming, const Vector &normal, bool entering, double index, Random &random) {
    const double ratio = entering ? 1.0 / index : index;
    const double cos_in = -dot(incoming, normal);
    const double square = 1.0 - ratio * ratio * (1.0 - cos_in * cos_in);
    if (square < 0.0) {
        return reflected(incoming, normal);
    }
    const double cos_out = std::sqrt(square);
    const double steep = 1.0 - (entering ? cos_in : cos_out);
    const double root = (index - 1.0) / (index + 1.0);
    const double head_on = root * root;
    const double reflectance = head_on + (1.0 - head_on) * steep * steep * steep * steep * steep;
    if (random.uniform() < reflectance) {
        return reflected(incoming, normal);
    }
    return normalised(incoming * ratio + normal * (ratio * cos_in - cos_out));
}

// Surfaces that a path meets before roulette begins.
constexpr int SURE_SURFACES = 5;

Vector radiance(const Scene &scene, Ray ray, Random &random) {
    Vector found{0.0, 0.0, 0.0};
    Vector throughput{1.0, 1.0, 1.0};
    int departed = NONE;
    for (int met = 1;; ++met) {
        double distance = std::numeric_limits<double>::max();
        const int number = first_hit(scene, ray, departed, distance);
        if (number == NONE) {
            return found;
        }
        const Surface &surface = scene.surfaces[number];
        found = found + times(throughput, surface.emission);
        // Also where nothing is reflected: there is no more light to be found.
        if (surface.strongest == 0.0) {
            return found;
        }
        throughput = times(throughput, surface.colour);
        if (met > SURE_SURFACES) {
            if (random.uniform() >= surface.strongest) {
                return found;
            }
            throughput = throughput * (1.0 / surface.strongest);
        }
        const Vector point = ray.origin + ray.direction * distance;
        const Vector outward = normalised(point - surface.centre);
        const bool entering = dot(outward, ray.direction) < 0.0;
        const Vector normal = entering ? outward : outward * -1.0;
        Vector direction;
        switch (surface.kind) {
        case DIFFUSE:
            direction = diffused(normal, random);
            break;
        case MIRROR:
            direction = reflected(ray.direction, normal);
            break;
        case GLASS:
            direction = through_glass(ray.direction, normal, entering, surface.index, random);
            break;
        }
        ray = {point, direction};
        departed = number;
    }
}

// A place of the tent filter over (-1, 1).
double tent(double uniform) {
    const double r = 2.0 * uniform;
    return r < 1.0 ? std::sqrt(r) - 1.0 : 1.0 - std::sqrt(2.0 - r);
}

struct Picture {
    int width, height, samples;
};

// A ray through the point `x`, `y` of the picture, in pixels from its upper left corner.
Ray camera_ray(const Camera &camera, const Picture &picture, double x, double y) {
    const Vector on_plane =
        camera.across * (x / picture.width - 0.5) + camera.upwards * (0.5 - y / picture.height);
    const Vector direction = normalised(camera.direction + on_plane);
    return {camera.position + direction * camera.near, direction};
}

struct Sums {
    Vector radiance, square;
};

std::vector<Sums> render(const Scene &scene, const Picture &picture, Random &random) {
    std::vector<Sums> all;
    all.reserve(4 * static_cast<std::size_t>(picture.width) * picture.height);
    for (int pixel = 0; pixel < picture.width * picture.height; ++pixel) {
        for (int sub_pixel = 0; sub_pixel < 4; ++sub_pixel) {
            const double left = pixel % picture.width + (sub_pixel % 2 + 0.5) / 2.0;
            const double top = pixel / picture.width + (sub_pixel / 2 + 0.5) / 2.0;
            Sums sums{};
            for (int sample = 0; sample < picture.samples; ++sample) {
                const double x = left + tent(random.uniform()) / 2.0;
                const double y = top + tent(random.uniform()) / 2.0;
                const Vector found = radiance(scene, camera_ray(scene.camera, picture, x, y), random);
                sums.radiance = sums.radiance + found;
                sums.square = sums.square + times(found, found);
            }
            all.push_back(sums);
        }
    }
    return all;
}

[[noreturn]] void fail(const char *message) {
    std::fprintf(stderr, "%s\n", message);
    std::exit(2);
}

double number(std::istream &text) {
    double value;
    if (!(text >> value)) {
        fail("the scene ends early, or a number of it is none");
    }
    return value;
}

// Braces are what keeps the order.
Vector vector(std::istream &text) {
    return {number(text), number(text), number(text)};
}

Camera read_camera(std::istream &text, const Picture &picture) {
    Camera camera;
    camera.position = vector(text);
    camera.direction = vector(text);
    const Vector up = vector(text);
    const double plane_height = number(text);
    camera.near = number(text);
    const double plane_width = plane_height * picture.width / picture.height;
    camera.across = normalised(cross(camera.direction, up)) * plane_width;
    camera.upwards = normalised(cross(camera.across, camera.direction)) * plane_height;
    return camera;
}

// Centre, radius, whether it is hollow, emission, colour, material and its index of refraction.
void read_sphere(std::istream &text, Scene &scene) {
    Sphere sphere;
    Surface surface;
    sphere.centre = surface.centre = vector(text);
    const double radius = number(text);
    sphere.square = radius * radius;
    sphere.hollow = number(text) != 0.0;
    surface.emission = vector(text);
    surface.colour = vector(text);
    surface.strongest = std::fmax(surface.colour.x, std::fmax(surface.colour.y, surface.colour.z));
    const int kind = static_cast<int>(number(text));
    if (kind < DIFFUSE || kind > GLASS) {
        fail("a sphere of the scene is of no known material");
    }
    surface.kind = static_cast<Kind>(kind);
    surface.index = number(text);
    scene.spheres.push_back(sphere);
    scene.surfaces.push_back(surface);
}

} // namespace

int main(int count, char **words) {
    if (count != 6) {
        fail("usage: plain SCENE WIDTH HEIGHT SAMPLES SEED");
    }
    std::ifstream text(words[1]);
    const Picture picture{std::atoi(words[2]), std::atoi(words[3]), std::atoi(words[4])};
    Random random(std::strtoull(words[5], nullptr, 10));
    Scene scene;
    scene.camera = read_camera(text, picture);
    for (int left = static_cast<int>(number(text)); left > 0; --left) {
        read_sphere(text, scene);
    }

    const auto start = std::chrono::steady_clock::now();
    const std::vector<Sums> all = render(scene, picture, random);
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;

    std::printf("%.9f\n", seconds.count());
    for (const auto &[sum, square] : all) {
        std::printf("%.17g %.17g %.17g %.17g %.17g %.17g\n", sum.x, sum.y, sum.z, square.x, square.y, square.z);
    }
    return std::fflush(stdout) == 0 ? 0 : 1;
}
