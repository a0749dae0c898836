// Things that stand under the sky.
#include <cmath>

#include "object_shapes.h"
#include "rigproof/core/conventions.h"

namespace rigproof {
namespace {

const Paint kBark = plain(0.36, 0.28, 0.20), kLeaf = plain(0.22, 0.40, 0.15), kDark = plain(0.10, 0.10, 0.11),
            kGlass = plain(0.14, 0.18, 0.22), kSteel = plain(0.55, 0.57, 0.60), kConcrete = plain(0.66, 0.65, 0.62);

void build_tree(ObjectShapes* s) {
  const Paint bark = s->main(kBark), leaves = s->second(kLeaf);
  const double trunk = 0.42 * s->height;
  s->upright({0.0, 0.0, 0.5 * trunk}, 0.05 * s->width + 0.04, trunk, bark);
  s->ellipsoid({0.0, 0.0, 0.66 * s->height}, {0.9 * s->depth, 0.9 * s->width, 0.62 * s->height}, leaves);
  for (int i = 0; i < 4; ++i) {
    const double around = 2.0 * kPi * (i + s->random.uniform(-0.3, 0.3)) / 4.0;
    const Paint tone = shaded(leaves, s->random.uniform(0.8, 1.12));
    s->ellipsoid({0.26 * s->depth * std::cos(around), 0.26 * s->width * std::sin(around),
                  s->random.uniform(0.5, 0.75) * s->height},
                 {0.55 * s->depth, 0.55 * s->width, 0.38 * s->height}, tone);
  }
}

void build_conifer(ObjectShapes* s) {
  const Paint leaves = s->second(plain(0.12, 0.27, 0.16));
  s->upright({0.0, 0.0, 0.1 * s->height}, 0.05 * s->width + 0.03, 0.2 * s->height, s->main(kBark));
  for (int i = 0; i < 4; ++i) {
    const double share = 1.0 - 0.23 * i;
    s->ellipsoid({0.0, 0.0, (0.26 + 0.19 * i) * s->height}, {share * s->depth, share * s->width, 0.36 * s->height},
                 shaded(leaves, 0.8 + 0.1 * i));
  }
}

void build_bush(ObjectShapes* s) {
  const Paint leaves = s->main(kLeaf);
  s->ellipsoid({0.0, 0.0, 0.4 * s->height}, {0.9 * s->depth, 0.8 * s->width, 1.1 * s->height}, leaves);
  for (const double y : {-0.28, 0.28}) {
    const Paint tone = shaded(leaves, s->random.uniform(0.8, 1.15));
    const double tall = s->random.uniform(0.6, 0.9);
    s->ellipsoid({s->random.uniform(-0.15, 0.15) * s->depth, y * s->width, s->random.uniform(0.2, 0.4) * s->height},
                 {0.75 * s->depth, 0.55 * s->width, tall * s->height}, tone);
  }
}

void build_rock(ObjectShapes* s) {
  const Paint stone = s->main(plain(0.52, 0.50, 0.47));
  s->ellipsoid({0.0, 0.0, 0.3 * s->height}, {s->depth, 0.9 * s->width, 1.4 * s->height}, stone);
  s->ellipsoid({0.2 * s->depth, 0.25 * s->width, 0.2 * s->height}, {0.6 * s->depth, 0.5 * s->width, 0.9 * s->height},
               shaded(stone, s->random.uniform(0.8, 1.05)));
}

void build_heap(ObjectShapes* s) {
  const Paint stones = s->main(plain(0.55, 0.52, 0.47));
  s->ellipsoid({0.0, 0.0, 0.0}, {0.9 * s->depth, s->width, 2.0 * s->height}, stones);
  s->ellipsoid({0.2 * s->depth, -0.2 * s->width, 0.0}, {0.6 * s->depth, 0.6 * s->width, 1.4 * s->height},
               shaded(stones, 0.93));
}

void build_hill(ObjectShapes* s) {
  s->ellipsoid({0.0, 0.0, 0.0}, {s->depth, s->width, 2.0 * s->height}, s->main(plain(0.36, 0.46, 0.26)));
}

void four_wheels(ObjectShapes* s, double radius, double track, double front, double rear) {
  for (const double x : {front, rear})
    for (const double y : {-0.5 * track, 0.5 * track}) {
      s->rod({x, y - 0.09, radius}, {x, y + 0.09, radius}, radius, kDark);
      s->rod({x, y - 0.095, radius}, {x, y + 0.095, radius}, 0.55 * radius, kSteel);
    }
}

void car_lights(ObjectShapes* s, double height) {
  for (const double y : {-0.38, 0.38}) {
    s->box({0.495 * s->depth, y * s->width, height}, {0.05, 0.18 * s->width, 0.10}, plain(0.95, 0.95, 0.9));
    s->box({-0.495 * s->depth, y * s->width, height}, {0.05, 0.16 * s->width, 0.12}, plain(0.6, 0.05, 0.05));
  }
  s->box({0.5 * s->depth, 0.0, 0.7 * height}, {0.03, 0.28 * s->width, 0.09}, plain(0.9, 0.9, 0.88));
  s->box({-0.5 * s->depth, 0.0, 0.8 * height}, {0.03, 0.28 * s->width, 0.09}, plain(0.9, 0.9, 0.88));
}

void build_car(ObjectShapes* s) {
  const Paint body = s->main(plain(0.6, 0.1, 0.1));
  s->box({0.0, 0.0, 0.40 * s->height}, {s->depth, s->width, 0.34 * s->height}, body);
  s->box({0.0, 0.0, 0.24 * s->height}, {0.98 * s->depth, 0.96 * s->width, 0.12 * s->height}, kDark);
  s->box({-0.05 * s->depth, 0.0, 0.74 * s->height}, {0.44 * s->depth, 0.86 * s->width, 0.34 * s->height}, kGlass);
  s->leaning_box({0.185 * s->depth, 0.0, 0.70 * s->height}, {0.06, 0.84 * s->width, 0.42 * s->height}, -32.0, kGlass);
  s->leaning_box({-0.285 * s->depth, 0.0, 0.70 * s->height}, {0.06, 0.84 * s->width, 0.42 * s->height}, 28.0, kGlass);
  s->box({-0.05 * s->depth, 0.0, 0.93 * s->height}, {0.40 * s->depth, 0.84 * s->width, 0.05 * s->height}, body);
  four_wheels(s, 0.22 * s->height, 0.92 * s->width, 0.31 * s->depth, -0.30 * s->depth);
  car_lights(s, 0.48 * s->height);
}

void build_van(ObjectShapes* s) {
  const Paint body = s->main(plain(0.9, 0.9, 0.88));
  s->box({-0.08 * s->depth, 0.0, 0.58 * s->height}, {0.84 * s->depth, s->width, 0.80 * s->height}, body);
  s->box({0.40 * s->depth, 0.0, 0.34 * s->height}, {0.2 * s->depth, 0.98 * s->width, 0.34 * s->height}, body);
  s->leaning_box({0.365 * s->depth, 0.0, 0.68 * s->height}, {0.05, 0.9 * s->width, 0.42 * s->height}, -28.0, kGlass);
  for (const double y : {-0.501, 0.501})
    s->box({0.24 * s->depth, y * s->width, 0.70 * s->height}, {0.16 * s->depth, 0.02, 0.26 * s->height}, kGlass);
  s->box({-0.08 * s->depth, 0.0, 0.44 * s->height}, {0.845 * s->depth, 1.01 * s->width, 0.08 * s->height},
         s->second(plain(0.15, 0.3, 0.55)));
  four_wheels(s, 0.16 * s->height, 0.93 * s->width, 0.32 * s->depth, -0.31 * s->depth);
  car_lights(s, 0.34 * s->height);
}

void build_lamp_post(ObjectShapes* s) {
  s->upright({0.0, 0.0, 0.5 * s->height}, 0.06, s->height, s->main(plain(0.35, 0.37, 0.38)));
  s->rod({0.0, 0.0, s->height}, {0.8 * s->depth, 0.0, s->height + 0.1}, 0.04, plain(0.35, 0.37, 0.38));
  s->box({0.9 * s->depth, 0.0, s->height + 0.09}, {0.5, 0.2, 0.08}, plain(0.8, 0.8, 0.78));
  s->box({0.0, 0.0, 0.15}, {0.35, 0.35, 0.3}, kConcrete);
}

void build_fence(ObjectShapes* s) {
  const Paint wood = s->main(plain(0.5, 0.38, 0.26));
  for (double y = -0.5 * s->width; y <= 0.5 * s->width + 1e-6;
       y += s->width / std::max(1.0, std::round(s->width / 2.0)))
    s->box({0.0, y, 0.5 * s->height}, {0.12, 0.12, s->height}, wood);
  for (const double z : {0.35, 0.62, 0.88})
    s->box({0.06, 0.0, z * s->height}, {0.04, s->width, 0.11 * s->height}, shaded(wood, s->random.uniform(0.85, 1.1)));
}

// Wire mesh between posts, as around building sites; the texture is the mesh's or an advertisement's.
void build_mesh_fence(ObjectShapes* s) {
  for (double y = -0.5 * s->width; y < 0.5 * s->width; y += 2.5) {
    const double wide = std::min(2.5, 0.5 * s->width - y);
    s->rod({0.0, y, 0.0}, {0.0, y, s->height}, 0.02, kSteel);
    s->rod({0.0, y, s->height}, {0.0, y + wide, s->height}, 0.02, kSteel);
    s->panel({0.0, y + 0.5 * wide, 0.52 * s->height}, wide - 0.06, 0.88 * s->height, s->main(plain(0.75, 0.75, 0.72)));
    s->box({0.0, y, 0.07}, {0.6, 0.22, 0.14}, kConcrete);
  }
}

void build_container(ObjectShapes* s) {
  const Paint steel = s->main(plain(0.16, 0.36, 0.50));
  s->box({0.0, 0.0, 0.5 * s->height}, {0.97 * s->depth, 0.97 * s->width, 0.96 * s->height}, steel);
  for (const double x : {-0.49, 0.49})
    for (const double y : {-0.49, 0.49})
      s->box({x * s->depth, y * s->width, 0.5 * s->height}, {0.12, 0.12, s->height}, shaded(steel, 0.75));
  for (const double y : {-0.3, -0.1, 0.1, 0.3})
    s->rod({0.5 * s->depth, y * s->width, 0.1}, {0.5 * s->depth, y * s->width, s->height - 0.1}, 0.025, kSteel);
}

void build_bench(ObjectShapes* s) {
  const Paint wood = s->main(plain(0.55, 0.40, 0.26));
  for (const double x : {-0.2, 0.05, 0.3}) s->box({x * s->depth, 0.0, 0.45}, {0.11, s->width, 0.035}, wood);
  for (const double z : {0.62, 0.78}) s->box({-0.42 * s->depth, 0.0, z}, {0.035, s->width, 0.11}, wood);
  for (const double y : {-0.4, 0.4}) {
    s->box({0.05 * s->depth, y * s->width, 0.22}, {0.75 * s->depth, 0.06, 0.43}, kDark);
    s->box({-0.46 * s->depth, y * s->width, 0.42}, {0.05, 0.06, 0.84}, kDark);
  }
}

void build_hay_bale(ObjectShapes* s) {
  s->rod({0.0, -0.5 * s->width, 0.5 * s->height}, {0.0, 0.5 * s->width, 0.5 * s->height}, 0.5 * s->height,
         s->main(plain(0.76, 0.64, 0.36)));
}

void build_log_pile(ObjectShapes* s) {
  const Paint bark = s->main(kBark);
  const double radius = s->height / 5.5;
  for (int row = 0; row < 3; ++row)
    for (int i = 0; i < 4 - row; ++i) {
      const double x = (i - 0.5 * (3 - row)) * 2.0 * radius, z = radius * (1.0 + 1.73 * row);
      const double shift = s->random.uniform(-0.06, 0.06) * s->width;
      s->rod({x, -0.5 * s->width + shift, z}, {x, 0.5 * s->width + shift, z}, 0.97 * radius,
             shaded(bark, s->random.uniform(0.8, 1.15)));
    }
}

void build_pipe_pile(ObjectShapes* s) {
  const double radius = s->height / 3.8;
  for (int row = 0; row < 2; ++row)
    for (int i = 0; i < 3 - row; ++i) {
      const double x = (i - 0.5 * (2 - row)) * 2.05 * radius, z = radius * (1.0 + 1.75 * row);
      s->rod({x, -0.5 * s->width, z}, {x, 0.5 * s->width, z}, radius, s->main(plain(0.78, 0.36, 0.16)));
      s->rod({x, -0.505 * s->width, z}, {x, 0.505 * s->width, z}, 0.8 * radius, kDark);
    }
}

void build_house(ObjectShapes* s) {
  const Paint wall = s->main(plain(0.85, 0.80, 0.70)), roof = s->second(plain(0.55, 0.25, 0.18));
  const double eaves = 0.62 * s->height;
  s->box({0.0, 0.0, 0.5 * eaves}, {s->depth, s->width, eaves}, wall);
  const double rise = s->height - eaves, half = 0.55 * s->depth;
  const double slope_deg = rad_to_deg(std::atan2(rise, half)), length = std::hypot(rise, half);
  for (const double side : {-1.0, 1.0})
    s->leaning_box({side * 0.5 * half, 0.0, eaves + 0.5 * rise}, {length, 1.06 * s->width, 0.12}, side * slope_deg,
                   roof);
  s->box({0.5 * s->depth, 0.0, 1.05}, {0.06, 1.0, 2.1}, plain(0.35, 0.22, 0.15));
  for (const double y : {-0.32, 0.32}) {
    s->box({0.5 * s->depth, y * s->width, 0.55 * eaves}, {0.06, 1.2, 1.1}, plain(0.92, 0.92, 0.9));
    s->box({0.505 * s->depth, y * s->width, 0.55 * eaves}, {0.06, 1.0, 0.9}, kGlass);
  }
}

void build_scaffold(ObjectShapes* s) {
  const int bays = std::max(1, static_cast<int>(std::lround(s->width / 2.0)));
  const int levels = std::max(1, static_cast<int>(std::lround(s->height / 2.0)));
  for (int i = 0; i <= bays; ++i)
    for (const double x : {-0.5, 0.5}) {
      const double y = s->width * (static_cast<double>(i) / bays - 0.5);
      s->rod({x * s->depth, y, 0.0}, {x * s->depth, y, s->height + 1.0}, 0.03, kSteel);
    }
  for (int level = 1; level <= levels; ++level) {
    const double z = s->height * level / levels;
    s->box({0.0, 0.0, z}, {s->depth, s->width, 0.05}, s->main(plain(0.6, 0.48, 0.32)));
    for (const double x : {-0.5, 0.5})
      s->rod({x * s->depth, -0.5 * s->width, z + 0.5}, {x * s->depth, 0.5 * s->width, z + 0.5}, 0.025, kSteel);
  }
  s->rod({0.5 * s->depth, -0.5 * s->width, 0.0}, {0.5 * s->depth, 0.5 * s->width, s->height}, 0.025, kSteel);
}

void build_excavator(ObjectShapes* s) {
  const Paint body = s->main(plain(0.90, 0.62, 0.08));
  for (const double y : {-0.38, 0.38})
    s->box({-0.2 * s->depth, y * s->width, 0.13 * s->height}, {0.48 * s->depth, 0.22 * s->width, 0.26 * s->height},
           kDark);
  s->box({-0.24 * s->depth, 0.0, 0.42 * s->height}, {0.42 * s->depth, 0.9 * s->width, 0.26 * s->height}, body);
  s->box({-0.12 * s->depth, 0.22 * s->width, 0.72 * s->height}, {0.18 * s->depth, 0.4 * s->width, 0.4 * s->height},
         kGlass);
  s->box({-0.12 * s->depth, 0.22 * s->width, 0.94 * s->height}, {0.19 * s->depth, 0.42 * s->width, 0.05 * s->height},
         body);
  s->leaning_box({0.10 * s->depth, -0.1 * s->width, 0.78 * s->height}, {0.42 * s->depth, 0.14 * s->width, 0.3}, -38.0,
                 body);
  s->leaning_box({0.36 * s->depth, -0.1 * s->width, 0.68 * s->height}, {0.36 * s->depth, 0.12 * s->width, 0.24}, 55.0,
                 body);
  s->box({0.45 * s->depth, -0.1 * s->width, 0.16 * s->height}, {0.6, 0.8, 0.55}, shaded(kSteel, 0.6));
}

void build_bollard(ObjectShapes* s) {
  s->upright({0.0, 0.0, 0.5 * s->height}, 0.5 * s->width, s->height, s->main(plain(0.85, 0.7, 0.1)));
  s->upright({0.0, 0.0, 0.75 * s->height}, 0.52 * s->width, 0.12 * s->height, kDark);
}

void build_barrel(ObjectShapes* s) {
  const Paint steel = s->main(plain(0.2, 0.4, 0.3));
  s->upright({0.0, 0.0, 0.5 * s->height}, 0.48 * s->width, s->height, steel);
  for (const double z : {0.05, 0.35, 0.65, 0.95})
    s->upright({0.0, 0.0, z * s->height}, 0.5 * s->width, 0.03, shaded(steel, 0.8));
}

void build_cone(ObjectShapes* s) {
  const Paint orange = s->main(plain(0.92, 0.36, 0.08));
  s->box({0.0, 0.0, 0.02}, {s->depth, s->width, 0.04}, orange);
  for (int i = 0; i < 5; ++i)
    s->upright({0.0, 0.0, 0.04 + (i + 0.5) * 0.19 * s->height}, (0.36 - 0.065 * i) * s->width, 0.19 * s->height,
               i == 2 ? plain(0.95, 0.95, 0.93) : orange);
}

void build_wheel_stop(ObjectShapes* s) {
  s->box({0.0, 0.0, 0.5 * s->height}, {s->depth, s->width, s->height}, s->main(kConcrete));
}

void build_sign(ObjectShapes* s) {
  s->upright({0.0, 0.0, 0.5 * s->height}, 0.03, s->height, kSteel);
  s->panel({0.04, 0.0, s->height - 0.5 * s->width}, s->width, s->width, s->main(plain(0.1, 0.25, 0.6)));
}

void build_flowers(ObjectShapes* s) {
  for (int i = 0; i < 6; ++i) {
    const double x = s->depth * s->random.uniform(-0.45, 0.45), y = s->width * s->random.uniform(-0.45, 0.45);
    const double tall = s->height * s->random.uniform(0.6, 1.0);
    s->upright({x, y, 0.5 * tall}, 0.008, tall, kLeaf);
    s->ellipsoid({x, y, tall}, {0.09, 0.09, 0.05}, s->main(plain(0.9, 0.8, 0.2)));
  }
}

void build_block(ObjectShapes* s) {
  s->box({0.0, 0.0, 0.5 * s->height}, {s->depth, s->width, s->height}, s->main(kConcrete));
}

}  // namespace

const ObjectKinds& outdoor_object_kinds() {
  static const ObjectKinds kinds = {
      {"barrel", {{0.58, 0.58, 0.88}, build_barrel}},
      {"bench", {{0.6, 1.7, 0.85}, build_bench}},
      {"block", {{0.8, 1.6, 0.8}, build_block}},
      {"bollard", {{0.2, 0.2, 0.9}, build_bollard}},
      {"bush", {{1.2, 1.8, 1.0}, build_bush}},
      {"car", {{4.3, 1.8, 1.48}, build_car}},
      {"cone", {{0.42, 0.42, 0.7}, build_cone}},
      {"conifer", {{2.6, 2.6, 6.5}, build_conifer, true}},
      {"container", {{6.06, 2.44, 2.6}, build_container}},
      {"excavator", {{6.0, 2.2, 2.8}, build_excavator}},
      {"fence", {{0.12, 6.0, 1.2}, build_fence, true}},
      {"flowers", {{0.6, 0.6, 0.35}, build_flowers}},
      {"hay_bale", {{1.3, 1.2, 1.3}, build_hay_bale}},
      {"heap", {{3.0, 3.5, 1.4}, build_heap}},
      {"hill", {{30.0, 50.0, 7.0}, build_hill, true}},
      {"house", {{7.0, 9.0, 5.5}, build_house, true}},
      {"lamp_post", {{1.2, 0.35, 5.0}, build_lamp_post, true}},
      {"log_pile", {{1.4, 3.0, 1.1}, build_log_pile}},
      {"mesh_fence", {{0.6, 10.0, 2.0}, build_mesh_fence, true}},
      {"pipe_pile", {{1.5, 4.0, 1.0}, build_pipe_pile}},
      {"rock", {{0.9, 0.9, 0.6}, build_rock}},
      {"scaffold", {{1.0, 6.0, 4.0}, build_scaffold, true}},
      {"sign", {{0.1, 0.6, 2.2}, build_sign}},
      {"tree", {{3.4, 3.4, 5.5}, build_tree, true}},
      {"van", {{5.2, 2.0, 2.3}, build_van}},
      {"wheel_stop", {{0.15, 1.7, 0.1}, build_wheel_stop}},
  };
  return kinds;
}

}  // namespace rigproof
