// Things that stand in rooms and halls.
#include "object_shapes.h"

namespace rigproof {
namespace {

const Paint kWood = plain(0.62, 0.45, 0.29), kDark = plain(0.13, 0.13, 0.15), kSteel = plain(0.55, 0.57, 0.60),
            kWhite = plain(0.90, 0.90, 0.88), kCarton = plain(0.70, 0.55, 0.38);

// Four legs under a top of the object's whole size.
void four_legs(ObjectShapes* s, double thickness, double top, const Paint& paint) {
  for (const double x : {-1.0, 1.0})
    for (const double y : {-1.0, 1.0})
      s->box({x * 0.5 * (s->depth - thickness), y * 0.5 * (s->width - thickness), 0.5 * top},
             {thickness, thickness, top}, paint);
}

// Boxes side by side on a board, of random sizes and slightly different colors.
void boxes_on(ObjectShapes* s, double from_y, double to_y, double depth, double room, double foot, const Paint& paint) {
  double y = from_y;
  while (y < to_y - 0.15) {
    const double width = std::min(s->random.uniform(0.25, 0.6) * (0.4 + 0.4 * depth), to_y - y);
    const double height = room * s->random.uniform(0.4, 0.92), inside = depth * s->random.uniform(0.7, 0.95);
    if (s->random.uniform() < 0.85)
      s->box({0.0, y + 0.5 * width, foot + 0.5 * height}, {inside, 0.94 * width, height},
             shaded(paint, s->random.uniform(0.7, 1.1)));
    y += width;
  }
}

void build_box(ObjectShapes* s) {
  s->box({0.0, 0.0, 0.5 * s->height}, {s->depth, s->width, s->height}, s->main(kCarton));
}

void build_boxes(ObjectShapes* s) {
  const Paint paint = s->main(kCarton);
  double foot = 0.0, share = 1.0;
  while (foot < 0.75 * s->height) {
    const double tall = s->height * s->random.uniform(0.25, 0.5);
    const Paint tone = shaded(paint, s->random.uniform(0.75, 1.1));
    s->box({s->depth * s->random.uniform(-0.06, 0.06), s->width * s->random.uniform(-0.06, 0.06), foot + 0.5 * tall},
           {share * 0.88 * s->depth, share * 0.88 * s->width, tall}, tone);
    foot += tall;
    share *= s->random.uniform(0.65, 0.95);
  }
}

void build_pallet(ObjectShapes* s) {
  const Paint wood = s->second(kWood), load = s->main(kCarton);
  for (const double y : {-0.42, 0.0, 0.42}) s->box({0.0, y * s->width, 0.055}, {s->depth, 0.10, 0.09}, wood);
  s->box({0.0, 0.0, 0.12}, {s->depth, s->width, 0.03}, wood);
  const double tall = 0.5 * (s->height - 0.14);
  for (const double level : {0.0, 1.0})
    for (const double x : {-0.25, 0.25})
      for (const double y : {-0.25, 0.25})
        if (level == 0.0 || s->random.uniform() < 0.75)
          s->box({x * s->depth, y * s->width, 0.14 + (level + 0.5) * tall},
                 {0.48 * s->depth, 0.48 * s->width, 0.97 * tall}, shaded(load, s->random.uniform(0.8, 1.08)));
}

void build_rack(ObjectShapes* s) {
  const Paint post = plain(0.10, 0.25, 0.55), beam = plain(0.90, 0.42, 0.08), load = s->main(kCarton);
  for (const double x : {-0.48, 0.48})
    for (const double y : {-0.49, 0.49})
      s->box({x * s->depth, y * s->width, 0.5 * s->height}, {0.08, 0.08, s->height}, post);
  constexpr int kLevels = 3;
  const double room = (s->height - 0.3) / kLevels;
  for (int level = 0; level < kLevels; ++level) {
    const double foot = 0.15 + room * level;
    for (const double x : {-0.48, 0.48}) s->box({x * s->depth, 0.0, foot}, {0.05, s->width, 0.11}, beam);
    s->box({0.0, 0.0, foot + 0.03}, {0.92 * s->depth, s->width, 0.03}, s->second(kSteel));
    boxes_on(s, -0.46 * s->width, 0.46 * s->width, 0.9 * s->depth, room - 0.2, foot + 0.045, load);
  }
}

void build_shelf(ObjectShapes* s) {
  const Paint frame = s->main(kSteel), things = s->second(kCarton);
  for (const double y : {-0.5, 0.5})
    s->box({0.0, y * (s->width - 0.03), 0.5 * s->height}, {s->depth, 0.03, s->height}, frame);
  constexpr int kLevels = 4;
  const double room = s->height / kLevels;
  for (int level = 0; level < kLevels; ++level) {
    const double foot = 0.08 + room * level;
    s->box({0.0, 0.0, foot}, {s->depth, s->width, 0.025}, frame);
    boxes_on(s, -0.46 * s->width, 0.46 * s->width, 0.85 * s->depth, room - 0.06, foot + 0.0125, things);
  }
}

// The second texture is a row of book spines.
void build_bookcase(ObjectShapes* s) {
  const Paint wood = s->main(kWood), books = s->second(plain(0.45, 0.3, 0.3));
  s->box({-0.4 * s->depth, 0.0, 0.5 * s->height}, {0.1 * s->depth, s->width, s->height}, shaded(wood, 0.7));
  for (const double y : {-0.5, 0.5})
    s->box({0.0, y * (s->width - 0.03), 0.5 * s->height}, {s->depth, 0.03, s->height}, wood);
  constexpr int kLevels = 5;
  const double room = (s->height - 0.1) / kLevels;
  for (int level = 0; level <= kLevels; ++level)
    s->box({0.0, 0.0, 0.08 + room * level}, {s->depth, s->width, 0.025}, wood);
  for (int level = 0; level < kLevels; ++level) {
    const double tall = room * s->random.uniform(0.68, 0.85), wide = s->random.uniform(0.6, 0.94) * (s->width - 0.06);
    const double side = s->random.uniform() < 0.5 ? -1.0 : 1.0;
    s->panel({0.32 * s->depth, side * 0.5 * (s->width - 0.06 - wide), 0.0925 + room * level + 0.5 * tall}, wide, tall,
             books);
  }
}

void build_cabinet(ObjectShapes* s) {
  const Paint body = s->main(kWhite);
  s->box({0.0, 0.0, 0.5 * s->height}, {s->depth, s->width, s->height}, body);
  s->box({0.5 * s->depth, 0.0, 0.5 * s->height}, {0.012, 0.012, 0.94 * s->height}, kDark);
  for (const double y : {-0.05, 0.05})
    s->box({0.5 * s->depth + 0.015, y, 0.55 * s->height}, {0.03, 0.015, 0.16}, kSteel);
}

void build_drawers(ObjectShapes* s) {
  const Paint body = s->main(kWhite);
  s->box({0.0, 0.0, 0.5 * s->height}, {s->depth, s->width, s->height}, body);
  for (const double z : {0.2, 0.5, 0.8}) {
    s->box({0.5 * s->depth, 0.0, (z + 0.13) * s->height}, {0.012, 0.96 * s->width, 0.012}, kDark);
    s->box({0.5 * s->depth + 0.015, 0.0, z * s->height}, {0.03, 0.3 * s->width, 0.018}, kSteel);
  }
}

void build_desk(ObjectShapes* s) {
  const Paint top = s->main(kWood), screen = s->second(plain(0.25, 0.40, 0.60));
  s->box({0.0, 0.0, s->height - 0.0125}, {s->depth, s->width, 0.025}, top);
  for (const double y : {-0.48, 0.48})
    s->box({0.0, y * s->width, 0.5 * s->height - 0.0125}, {0.06, 0.05, s->height - 0.025}, kSteel);
  s->box({0.08, 0.30 * s->width, 0.32}, {0.8 * s->depth, 0.40, 0.56}, shaded(kWhite, 0.85));
  for (const double y : {-0.20, 0.22}) {
    s->box({-0.24 * s->depth, y * s->width, s->height + 0.30}, {0.03, 0.56, 0.34}, kDark);
    s->panel({-0.24 * s->depth + 0.018, y * s->width, s->height + 0.30}, 0.53, 0.31, screen);
    s->box({-0.26 * s->depth, y * s->width, s->height + 0.07}, {0.16, 0.18, 0.14}, kDark);
  }
  s->box({0.2 * s->depth, -0.05 * s->width, s->height + 0.012}, {0.15, 0.45, 0.02}, kDark);
  s->box({0.2 * s->depth, -0.35 * s->width, s->height + 0.03}, {0.30, 0.22, 0.06},
         shaded(kWhite, s->random.uniform(0.7, 1.0)));
}

void build_table(ObjectShapes* s) {
  const Paint wood = s->main(kWood);
  s->box({0.0, 0.0, s->height - 0.02}, {s->depth, s->width, 0.04}, wood);
  four_legs(s, 0.06, s->height - 0.04, shaded(wood, 0.8));
}

void build_chair(ObjectShapes* s) {
  const Paint wood = s->main(kWood);
  const double seat = 0.52 * s->height;
  s->box({0.0, 0.0, seat}, {s->depth, s->width, 0.04}, s->second(wood));
  four_legs(s, 0.035, seat, wood);
  s->box({-0.46 * s->depth, 0.0, 0.80 * s->height}, {0.035, s->width, 0.36 * s->height}, wood);
}

void build_office_chair(ObjectShapes* s) {
  const Paint cloth = s->main(plain(0.15, 0.17, 0.22));
  s->box({0.05, 0.0, 0.46 * s->height}, {0.48, 0.5, 0.08}, cloth);
  s->leaning_box({-0.24, 0.0, 0.76 * s->height}, {0.06, 0.46, 0.50 * s->height}, -8.0, cloth);
  s->upright({0.0, 0.0, 0.24 * s->height}, 0.03, 0.38 * s->height, kDark);
  s->box({0.0, 0.0, 0.05}, {s->depth, 0.06, 0.04}, kDark);
  s->box({0.0, 0.0, 0.05}, {0.06, s->width, 0.04}, kDark);
}

void build_sofa(ObjectShapes* s) {
  const Paint cloth = s->main(plain(0.35, 0.38, 0.42)), cushion = s->second(shaded(cloth, 1.15));
  s->box({0.0, 0.0, 0.22}, {s->depth, s->width, 0.36}, cloth);
  s->box({-0.40 * s->depth, 0.0, 0.5 * s->height}, {0.2 * s->depth, s->width, s->height}, cloth);
  for (const double y : {-1.0, 1.0})
    s->box({0.0, y * (0.5 * s->width - 0.09), 0.36 * s->height + 0.1}, {s->depth, 0.18, 0.55 * s->height}, cloth);
  for (const double y : {-0.25, 0.25})
    s->leaning_box({-0.22 * s->depth, y * s->width, 0.66 * s->height}, {0.14, 0.36 * s->width, 0.42}, -14.0, cushion);
}

void build_bed(ObjectShapes* s) {
  const Paint wood = s->main(kWood), cloth = s->second(plain(0.85, 0.83, 0.78));
  s->box({0.0, 0.0, 0.20}, {s->depth, s->width, 0.24}, wood);
  s->box({0.0, 0.0, 0.41}, {0.97 * s->depth, 0.96 * s->width, 0.20}, cloth);
  s->box({-0.49 * s->depth, 0.0, 0.5 * s->height}, {0.05, s->width, s->height}, wood);
  for (const double y : {-0.24, 0.24})
    s->box({-0.36 * s->depth, y * s->width, 0.56}, {0.4, 0.40 * s->width, 0.12}, kWhite);
}

void build_plant(ObjectShapes* s) {
  const Paint leaves = s->second(plain(0.16, 0.38, 0.16));
  const double pot = 0.28 * s->height;
  s->upright({0.0, 0.0, 0.5 * pot}, 0.32 * s->width, pot, s->main(plain(0.72, 0.45, 0.33)));
  s->upright({0.0, 0.0, 0.5 * s->height}, 0.03 * s->width, 0.6 * s->height, plain(0.35, 0.26, 0.18));
  for (int i = 0; i < 5; ++i) {
    const double at = s->random.uniform(0.5, 0.86) * s->height, size = s->random.uniform(0.4, 0.65) * s->width;
    const Paint tone = shaded(leaves, s->random.uniform(0.75, 1.15));
    s->ellipsoid({0.25 * s->depth * s->random.uniform(-1.0, 1.0), 0.25 * s->width * s->random.uniform(-1.0, 1.0), at},
                 {size, size, 0.28 * s->height}, tone);
  }
}

void build_floor_lamp(ObjectShapes* s) {
  s->upright({0.0, 0.0, 0.015}, 0.4 * s->width, 0.03, kDark);
  s->upright({0.0, 0.0, 0.5 * s->height}, 0.015, s->height, kSteel);
  s->upright({0.0, 0.0, 0.9 * s->height}, 0.5 * s->width, 0.2 * s->height, s->main(glow(1.0, 0.93, 0.75)));
}

void build_television(ObjectShapes* s) {
  s->box({0.0, 0.0, 0.22}, {s->depth, s->width, 0.44}, s->main(kWood));
  const double tall = s->height - 0.55;
  s->box({0.0, 0.0, 0.52 + 0.5 * tall}, {0.05, 0.85 * s->width, tall}, kDark);
  s->panel({0.03, 0.0, 0.52 + 0.5 * tall}, 0.83 * s->width, 0.95 * tall, s->second(plain(0.05, 0.06, 0.09)));
  s->box({0.0, 0.0, 0.48}, {0.2, 0.4, 0.08}, kDark);
}

void build_counter(ObjectShapes* s) {
  const Paint front = s->main(kWhite), top = s->second(plain(0.30, 0.30, 0.32));
  s->box({-0.02, 0.0, 0.5 * s->height - 0.02}, {s->depth - 0.04, s->width, s->height - 0.04}, front);
  s->box({0.0, 0.0, s->height - 0.02}, {s->depth, s->width, 0.04}, top);
  for (double y = -0.5 * s->width + 0.6; y < 0.5 * s->width - 0.1; y += 0.6)
    s->box({0.5 * s->depth - 0.03, y, 0.48 * s->height}, {0.012, 0.01, 0.85 * s->height}, kDark);
  s->box({0.0, -0.25 * s->width, s->height + 0.10}, {0.22, 0.3, 0.20}, kSteel);
  s->upright({0.05, 0.05 * s->width, s->height + 0.09}, 0.08, 0.18, plain(0.75, 0.2, 0.15));
  s->upright({0.0, 0.3 * s->width, s->height + 0.06}, 0.12, 0.12, kSteel);
}

void build_door(ObjectShapes* s) {
  const Paint leaf = s->main(kWood);
  s->box({0.0, 0.0, 0.5 * s->height}, {s->depth, s->width, s->height}, s->second(plain(0.35, 0.36, 0.38)));
  s->panel({0.5 * s->depth, 0.0, 0.49 * s->height}, 0.88 * s->width, 0.95 * s->height, leaf);
  s->box({0.5 * s->depth + 0.03, 0.36 * s->width, 0.48 * s->height}, {0.05, 0.12, 0.02}, kSteel);
}

void build_window(ObjectShapes* s) {
  s->box({0.0, 0.0, 0.5 * s->height}, {s->depth, s->width, s->height}, kWhite);
  for (const double y : {-0.25, 0.25})
    s->panel({0.5 * s->depth, y * s->width, 0.5 * s->height}, 0.44 * s->width, 0.9 * s->height,
             s->main(glow(0.78, 0.88, 0.98)));
}

void build_picture(ObjectShapes* s) {
  s->box({0.0, 0.0, 0.5 * s->height}, {s->depth, s->width, s->height}, s->second(kDark));
  s->panel({0.5 * s->depth, 0.0, 0.5 * s->height}, 0.93 * s->width, 0.93 * s->height, s->main(kWhite));
}

void build_curtain(ObjectShapes* s) {
  const Paint cloth = s->main(plain(0.6, 0.3, 0.25));
  const int folds = std::max(2, static_cast<int>(s->width / 0.14));
  for (int i = 0; i < folds; ++i)
    s->upright({0.0, s->width * ((i + 0.5) / folds - 0.5), 0.5 * s->height}, 0.55 * s->width / folds, s->height,
               shaded(cloth, i % 2 == 0 ? 1.0 : 0.86));
}

void build_radiator(ObjectShapes* s) {
  for (double y = -0.5 * s->width + 0.05; y < 0.5 * s->width; y += 0.1)
    s->box({0.0, y, 0.12 + 0.5 * (s->height - 0.12)}, {s->depth, 0.06, s->height - 0.12}, s->main(kWhite));
}

void build_workbench(ObjectShapes* s) {
  s->box({0.0, 0.0, s->height - 0.03}, {s->depth, s->width, 0.06}, s->main(kWood));
  four_legs(s, 0.08, s->height - 0.06, s->second(plain(0.2, 0.35, 0.3)));
  s->box({0.0, 0.0, 0.25}, {0.9 * s->depth, 0.9 * s->width, 0.03}, kSteel);
  s->box({0.42 * s->depth, -0.35 * s->width, s->height + 0.09}, {0.22, 0.14, 0.18}, plain(0.15, 0.3, 0.5));
  boxes_on(s, -0.1 * s->width, 0.45 * s->width, 0.5 * s->depth, 0.3, s->height, plain(0.65, 0.2, 0.15));
}

void build_lathe(ObjectShapes* s) {
  const Paint body = s->main(plain(0.30, 0.45, 0.40));
  for (const double y : {-0.36, 0.36})
    s->box({0.0, y * s->width, 0.29 * s->height}, {0.8 * s->depth, 0.2 * s->width, 0.58 * s->height}, body);
  s->box({0.0, 0.0, 0.62 * s->height}, {0.6 * s->depth, s->width, 0.10 * s->height}, kSteel);
  s->box({0.0, 0.36 * s->width, 0.82 * s->height}, {0.7 * s->depth, 0.26 * s->width, 0.36 * s->height}, body);
  s->rod({0.0, 0.23 * s->width, 0.84 * s->height}, {0.0, 0.14 * s->width, 0.84 * s->height}, 0.11, kSteel);
  s->box({0.05, -0.12 * s->width, 0.72 * s->height}, {0.3, 0.22, 0.14}, kDark);
  s->box({0.0, -0.42 * s->width, 0.77 * s->height}, {0.24, 0.16 * s->width, 0.22 * s->height}, body);
  s->panel({0.36 * s->depth, 0.36 * s->width, 0.86 * s->height}, 0.2, 0.14, plain(0.95, 0.85, 0.1));
}

void build_drill_press(ObjectShapes* s) {
  const Paint body = s->main(plain(0.20, 0.38, 0.55));
  s->box({0.0, 0.0, 0.05}, {s->depth, s->width, 0.10}, kDark);
  s->upright({-0.2 * s->depth, 0.0, 0.5 * s->height}, 0.06, s->height, kSteel);
  s->box({0.1 * s->depth, 0.0, 0.48 * s->height}, {0.55 * s->depth, 0.8 * s->width, 0.05}, kSteel);
  s->box({0.0, 0.0, 0.85 * s->height}, {0.95 * s->depth, 0.6 * s->width, 0.22 * s->height}, body);
  s->upright({0.2 * s->depth, 0.0, 0.66 * s->height}, 0.03, 0.2 * s->height, kDark);
}

void build_tool_trolley(ObjectShapes* s) {
  const Paint body = s->main(plain(0.70, 0.12, 0.10));
  s->box({0.0, 0.0, 0.5 * s->height + 0.06}, {s->depth, s->width, s->height - 0.12}, body);
  for (int i = 1; i < 6; ++i)
    s->box({0.5 * s->depth, 0.0, 0.12 + i * (s->height - 0.14) / 6.0}, {0.016, 0.92 * s->width, 0.014}, kSteel);
  for (const double x : {-0.4, 0.4})
    for (const double y : {-0.42, 0.42}) s->upright({x * s->depth, y * s->width, 0.06}, 0.05, 0.12, kDark);
}

void build_ladder(ObjectShapes* s) {
  for (const double y : {-0.5, 0.5})
    s->rod({0.45 * s->depth, y * s->width, 0.0}, {-0.45 * s->depth, y * s->width, s->height}, 0.025,
           s->main(plain(0.8, 0.8, 0.78)));
  for (double t = 0.1; t < 0.98; t += 0.125)
    s->rod({(0.45 - 0.9 * t) * s->depth, -0.5 * s->width, t * s->height},
           {(0.45 - 0.9 * t) * s->depth, 0.5 * s->width, t * s->height}, 0.016, kSteel);
}

void build_column(ObjectShapes* s) {
  s->box({0.0, 0.0, 0.5 * s->height}, {s->depth, s->width, s->height}, s->main(plain(0.7, 0.7, 0.68)));
  s->box({0.0, 0.0, 0.6}, {s->depth + 0.03, s->width + 0.03, 1.2}, s->second(plain(0.85, 0.7, 0.1)));
}

void build_extinguisher(ObjectShapes* s) {
  s->upright({0.0, 0.0, 0.44 * s->height}, 0.5 * s->width, 0.88 * s->height, plain(0.75, 0.08, 0.06));
  s->box({0.0, 0.0, 0.92 * s->height}, {0.5 * s->width, 0.8 * s->width, 0.1 * s->height}, kDark);
}

void build_bin(ObjectShapes* s) {
  s->upright({0.0, 0.0, 0.5 * s->height}, 0.5 * s->width, s->height, s->main(plain(0.25, 0.27, 0.30)));
  s->upright({0.0, 0.0, s->height}, 0.46 * s->width, 0.02, kDark);
}

void build_forklift(ObjectShapes* s) {
  const Paint body = s->main(plain(0.92, 0.60, 0.08));
  s->box({-0.16 * s->depth, 0.0, 0.28 * s->height}, {0.55 * s->depth, 0.9 * s->width, 0.36 * s->height}, body);
  s->box({-0.36 * s->depth, 0.0, 0.36 * s->height}, {0.2 * s->depth, 0.95 * s->width, 0.4 * s->height},
         shaded(body, 0.8));
  for (const double x : {-0.36, 0.08})
    for (const double y : {-0.42, 0.42})
      s->rod({x * s->depth, y * s->width, 0.4 * s->height}, {x * s->depth * 0.9, y * s->width, s->height}, 0.03, kDark);
  s->box({-0.14 * s->depth, 0.0, s->height}, {0.5 * s->depth, 0.9 * s->width, 0.04}, kDark);
  for (const double y : {-0.22, 0.22}) {
    s->box({0.16 * s->depth, y * s->width, 0.55 * s->height}, {0.08, 0.08, 1.1 * s->height}, kDark);
    s->box({0.34 * s->depth, y * s->width, 0.05}, {0.34 * s->depth, 0.1, 0.04}, kSteel);
  }
  for (const double x : {-0.32, 0.06})
    for (const double y : {-0.45, 0.45})
      s->rod({x * s->depth, (y - 0.06) * s->width, 0.2}, {x * s->depth, (y + 0.06) * s->width, 0.2}, 0.2, kDark);
}

}  // namespace

const ObjectKinds& indoor_object_kinds() {
  static const ObjectKinds kinds = {
      {"bed", {{2.05, 1.6, 0.95}, build_bed}},
      {"bin", {{0.32, 0.32, 0.42}, build_bin}},
      {"bookcase", {{0.32, 1.0, 2.0}, build_bookcase}},
      {"box", {{0.45, 0.45, 0.40}, build_box}},
      {"boxes", {{0.6, 0.6, 1.2}, build_boxes}},
      {"cabinet", {{0.45, 0.9, 1.9}, build_cabinet}},
      {"chair", {{0.44, 0.44, 0.90}, build_chair}},
      {"column", {{0.4, 0.4, 3.0}, build_column, true}},
      {"counter", {{0.62, 2.4, 0.92}, build_counter, true}},
      {"curtain", {{0.12, 0.7, 2.4}, build_curtain, true}},
      {"desk", {{0.75, 1.6, 0.74}, build_desk}},
      {"door", {{0.06, 1.0, 2.1}, build_door, true}},
      {"drawers", {{0.5, 0.8, 0.9}, build_drawers}},
      {"drill_press", {{0.6, 0.45, 1.75}, build_drill_press}},
      {"extinguisher", {{0.17, 0.17, 0.55}, build_extinguisher, true}},
      {"floor_lamp", {{0.4, 0.4, 1.65}, build_floor_lamp}},
      {"forklift", {{2.6, 1.15, 2.1}, build_forklift}},
      {"ladder", {{0.7, 0.45, 2.4}, build_ladder}},
      {"lathe", {{0.75, 1.9, 1.35}, build_lathe}},
      {"office_chair", {{0.62, 0.62, 1.05}, build_office_chair}},
      {"pallet", {{1.2, 0.8, 1.25}, build_pallet}},
      {"picture", {{0.03, 0.7, 0.5}, build_picture, true}},
      {"plant", {{0.7, 0.7, 1.5}, build_plant}},
      {"rack", {{1.0, 2.8, 3.6}, build_rack, true}},
      {"radiator", {{0.1, 1.0, 0.6}, build_radiator, true}},
      {"shelf", {{0.45, 1.1, 1.9}, build_shelf}},
      {"sofa", {{0.9, 2.0, 0.85}, build_sofa}},
      {"table", {{0.8, 1.4, 0.74}, build_table}},
      {"television", {{0.42, 1.7, 1.25}, build_television}},
      {"tool_trolley", {{0.48, 0.75, 1.0}, build_tool_trolley}},
      {"window", {{0.04, 1.4, 1.2}, build_window, true}},
      {"workbench", {{0.75, 2.0, 0.9}, build_workbench}},
  };
  return kinds;
}

}  // namespace rigproof
