// Reads a STEP or IGES file with Open CASCADE and prints what it holds: "valid V faces F area A tolerance T".

#include <BRep_Tool.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <BRepGProp.hxx>
#include <GProp_GProps.hxx>
#include <IGESControl_Reader.hxx>
#include <ShapeAnalysis_ShapeTolerance.hxx>
#include <STEPControl_Reader.hxx>
#include <TopExp_Explorer.hxx>

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <iostream>
#include <sstream>

template <class Reader> static int describe(const char *path)
{
    Reader reader;
    // Messages of the reader are no part of the output.
    std::streambuf *output = std::cout.rdbuf();
    std::ostringstream messages;
    std::cout.rdbuf(messages.rdbuf());
    bool read = reader.ReadFile(path) == IFSelect_RetDone && reader.TransferRoots() > 0;
    std::cout.rdbuf(output);
    if (!read)
        return 1;
    TopoDS_Shape shape = reader.OneShape();
    int faces = 0;
    for (TopExp_Explorer each(shape, TopAbs_FACE); each.More(); each.Next())
        faces++;
    GProp_GProps properties;
    BRepGProp::SurfaceProperties(shape, properties, 1e-6);
    ShapeAnalysis_ShapeTolerance tolerance;
    std::printf("valid %d faces %d area %.12g tolerance %.3g\n", BRepCheck_Analyzer(shape).IsValid() ? 1 : 0, faces,
                properties.Mass(), tolerance.Tolerance(shape, 1));
    return 0;
}

int main(int argc, char **argv)
{
    if (argc != 2)
        return 2;
    const char *ending = std::strrchr(argv[1], '.');
    if (ending != nullptr && std::strncmp(ending, ".ig", 3) == 0)
        return describe<IGESControl_Reader>(argv[1]);
    return describe<STEPControl_Reader>(argv[1]);
}
