// A sheet falls on a ball; a hand lifts a corner and lets it go. Writes the last frame as drape.obj.
//
//     drape SCENE
#include <muslin.h>

#include <algorithm>
#include <cstddef>
#include <fstream>
#include <iostream>
#include <iterator>
#include <new>
#include <stdexcept>
#include <vector>

// Memory that begins at a multiple of 32.
struct alignas(32) Block {
    unsigned char bytes[32];
};

static std::vector<Block> blocks(std::size_t bytes) { return std::vector<Block>((bytes + 31) / 32); }

static void check(MuslinStatus status, const MuslinCloth *cloth = nullptr) {
    if (status == MUSLIN_STATUS_OK) return;
    char words[200] = "";
    muslin_error(cloth, words, sizeof words);
    throw std::runtime_error(words[0] ? words : muslin_message(status));
}

// A cloth that owns its memory.
class Cloth {
  public:
    explicit Cloth(const char *path) {
        std::ifstream file(path, std::ios::binary);
        if (!file) throw std::runtime_error("cannot read the scene");
        const std::vector<char> bytes{std::istreambuf_iterator<char>(file), {}};
        scene = blocks(bytes.size());
        std::copy(bytes.begin(), bytes.end(), reinterpret_cast<char *>(scene.data()));
        const auto *start = reinterpret_cast<const unsigned char *>(scene.data());
        std::size_t needed = 0;
        check(muslin_required_bytes(start, bytes.size(), &needed));
        memory = blocks(needed);
        check(muslin_open(start, bytes.size(), reinterpret_cast<unsigned char *>(memory.data()), needed, &handle));
    }
    Cloth(const Cloth &) = delete;
    Cloth &operator=(const Cloth &) = delete;
    operator MuslinCloth *() const { return handle; }

  private:
    std::vector<Block> scene, memory;
    MuslinCloth *handle = nullptr;
};

int main(int count, char **words) try {
    if (count != 2) throw std::runtime_error("usage: drape SCENE");
    Cloth cloth(words[1]);
    const double step = muslin_step_length(cloth);
    for (int n = 0; n < 120; n++) {
        if (n < 60) {
            const double place[3] = {-0.5, 0.3 + 0.2 * n * step, -0.5};
            check(muslin_move_to(cloth, 0, place, step), cloth);
        } else if (n == 60) {
            check(muslin_release(cloth, 0), cloth);
        }
        check(muslin_step(cloth, nullptr, nullptr), cloth);
    }
    std::size_t vertices = 0, triangles = 0;
    const float *positions = muslin_positions(cloth, &vertices);
    const float *normals = muslin_normals(cloth, &vertices);
    const std::uint32_t *corners = muslin_triangles(cloth, &triangles);
    std::ofstream out("drape.obj");
    for (std::size_t i = 0; i < 3 * vertices; i += 3) {
        out << "v " << positions[i] << ' ' << positions[i + 1] << ' ' << positions[i + 2] << '\n';
        out << "vn " << normals[i] << ' ' << normals[i + 1] << ' ' << normals[i + 2] << '\n';
    }
    for (std::size_t i = 0; i < 3 * triangles; i += 3)
        out << "f " << corners[i] + 1 << "//" << corners[i] + 1 << ' ' << corners[i + 1] + 1 << "//" << corners[i + 1] + 1 << ' '
            << corners[i + 2] + 1 << "//" << corners[i + 2] + 1 << '\n';
    std::cout << vertices << " vertices, hash " << std::hex << muslin_hash(cloth) << '\n';
    return out.flush() ? 0 : 1;
} catch (const std::exception &error) {
    std::cerr << error.what() << '\n';
    return 1;
}
