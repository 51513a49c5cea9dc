// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

// Exported by Gmsh 4.8, but declared in no header that is installed: of each class what is called
// here, none of which is virtual in the call. Names are Gmsh's:
// NOLINTBEGIN(readability-identifier-naming)
class Field;
class GEntity;
class SMetric3 {
public:
    std::array<double, 6> lower_triangle{};
};
class FieldManager {
public:
    Field* get(int tag);
};
class GModel {
public:
    static std::vector<GModel*> list;
    static GModel* current(int index = -1);
    static int setCurrent(GModel* model);
    FieldManager* getFields();
};
class PostViewField {
public:
    double operator()(double x, double y, double z, GEntity* entity);
    void operator()(double x, double y, double z, SMetric3& metric, GEntity* entity);
};
class StructuredField {
public:
    double operator()(double x, double y, double z, GEntity* entity);
};
// NOLINTEND(readability-identifier-naming)
