#pragma once

#include "io/curve/geojson.h"

#include <cpl_conv.h>
#include <cpl_error.h>
#include <cpl_string.h>
#include <cpl_vsi.h>
#include <gdal.h>
#include <ogr_api.h>
#include <ogr_srs_api.h>

/// @file
/// The functions of GDAL, from its library when that is loaded.

/// The functions in use. GDAL loads more than a hundred libraries, so batten is not linked with it.
// clang-format off
#define GDAL_FUNCTIONS(X) \
    X(CPLBinaryToHex) X(CPLGetErrorHandlerUserData) X(CPLHexToBinary) X(CPLIsUTF8) X(CPLPopErrorHandler) \
    X(CPLPushErrorHandlerEx) X(CPLRecode) X(CPLSetThreadLocalConfigOption) X(CSLDestroy) X(CSLSetNameValue) X(CSLTokenizeString2) X(GDALAllRegister) \
    X(GDALClose) X(GDALCreate) X(GDALDatasetRasterIO) X(GDALGetRasterBand) X(GDALGetRasterColorTable) X(GDALGetRasterCount) \
    X(GDALGetRasterDataType) X(GDALGetRasterXSize) X(GDALGetRasterYSize) X(VSIFileFromMemBuffer) X(VSIUnlink) X(GDALDatasetCreateLayer) X(GDALDatasetGetLayer) X(GDALDatasetGetLayerByName) \
    X(GDALDatasetGetLayerCount) X(GDALGetDatasetDriver) X(GDALGetDriver) X(GDALGetDriverByName) X(GDALGetDriverCount) \
    X(GDALGetDriverShortName) X(GDALGetMetadataItem) X(GDALIdentifyDriverEx) X(GDALOpenEx) X(OCTDestroyCoordinateTransformation) \
    X(OCTNewCoordinateTransformation) X(OCTTransformEx) X(OGR_FD_GetFieldCount) X(OGR_FD_GetFieldDefn) \
    X(OGR_FD_Reference) X(OGR_FD_Release) X(OGR_F_Create) X(OGR_F_Destroy) X(OGR_F_GetFID) X(OGR_F_GetFieldAsBinary) \
    X(OGR_F_GetFieldAsDateTimeEx) X(OGR_F_GetFieldAsDouble) X(OGR_F_GetFieldAsDoubleList) X(OGR_F_GetFieldAsInteger64) \
    X(OGR_F_GetFieldAsInteger64List) X(OGR_F_GetFieldAsIntegerList) X(OGR_F_GetFieldAsString) \
    X(OGR_F_GetFieldAsStringList) X(OGR_F_IsFieldNull) X(OGR_F_IsFieldSet) X(OGR_F_SetFID) X(OGR_F_SetFieldBinary) \
    X(OGR_F_SetFieldDouble) X(OGR_F_SetFieldDoubleList) X(OGR_F_SetFieldInteger64) X(OGR_F_SetFieldInteger64List) \
    X(OGR_F_SetFieldNull) X(OGR_F_SetFieldString) X(OGR_F_SetFieldStringList) X(OGR_F_SetGeometryDirectly) \
    X(OGR_F_StealGeometry) X(OGR_Fld_Create) X(OGR_Fld_Destroy) X(OGR_Fld_GetNameRef) X(OGR_Fld_GetSubType) \
    X(OGR_Fld_GetType) X(OGR_Fld_SetSubType) X(OGR_GT_Flatten) X(OGR_GT_HasM) X(OGR_GT_HasZ) X(OGR_GT_SetModifier) \
    X(OGR_G_AddGeometryDirectly) X(OGR_G_AddPoint) X(OGR_G_AddPointM) X(OGR_G_AddPointZM) X(OGR_G_AddPoint_2D) \
    X(OGR_G_CloseRings) X(OGR_G_CreateGeometry) X(OGR_G_DestroyGeometry) X(OGR_G_ForceToMultiLineString) \
    X(OGR_G_ForceToMultiPolygon) X(OGR_G_GetGeometryCount) X(OGR_G_GetGeometryName) X(OGR_G_GetGeometryRef) \
    X(OGR_G_GetGeometryType) X(OGR_G_GetLinearGeometry) X(OGR_G_GetPointCount) X(OGR_G_GetPointZM) \
    X(OGR_G_HasCurveGeometry) X(OGR_G_Is3D) X(OGR_G_IsEmpty) X(OGR_G_IsMeasured) X(OGR_G_Set3D) X(OGR_G_SetMeasured) \
    X(OGR_G_SwapXY) X(OGR_G_Transform) X(OGR_L_CommitTransaction) X(OGR_L_CreateFeature) X(OGR_L_CreateField) \
    X(OGR_L_FindFieldIndex) X(OGR_L_GetExtent) X(OGR_L_GetFIDColumn) X(OGR_L_GetFeatureCount) X(OGR_L_GetGeomType) \
    X(OGR_L_GetLayerDefn) X(OGR_L_GetName) X(OGR_L_GetNextFeature) X(OGR_L_GetSpatialRef) X(OGR_L_ResetReading) \
    X(OGR_L_StartTransaction) X(OSRClone) X(OSRCloneGeogCS) X(OSRDestroySpatialReference) X(OSRExportToWktEx) \
    X(OSRGetAngularUnits) X(OSRGetAuthorityCode) X(OSRGetAuthorityName) X(OSRGetDataAxisToSRSAxisMapping) \
    X(OSRGetPrimeMeridian) X(OSRIsGeographic) X(OSRIsSame) X(OSRNewSpatialReference) X(OSRSetAxisMappingStrategy) \
    X(OSRSetFromUserInput) X(VSIFCloseL) X(VSIFOpenL) X(VSIFReadL) X(VSIFWriteL) X(VSIFree) X(VSIRmdirRecursive)
// clang-format on

#define GDAL_MEMBER(name) __typeof__(name) *name; // NOLINT(bugprone-macro-parentheses): a member
typedef struct gdal_functions
{
    GDAL_FUNCTIONS(GDAL_MEMBER)
} gdal_functions;
#undef GDAL_MEMBER

/// Valid from the first successful gdal_begin() on.
extern gdal_functions gdal;

typedef struct gdal_messages
{
    char text[BAT_ERROR_TEXT_SIZE / 2]; ///< the first failure
    size_t failures;
} gdal_messages;

/// Load GDAL and collect its messages, which it would print otherwise, until gdal_end() on the same thread.
/// @return BAT_OK or BAT_UNSUPPORTED (the library of GDAL is not there); then without gdal_end()
bat_status gdal_begin(gdal_messages *messages, bat_error *error);
void gdal_end(void);

/// Fail with a text and, after a colon, what GDAL says.
bat_status gdal_fault(const gdal_messages *messages, bat_status status, bat_error *error, const char *what);

/// The path by which GDAL opens a file: with /vsigzip/ for ".gz", /vsizip/ for ".zip", and for GML by a way that
/// is only read. Null when out of memory.
char *gdal_path(const char *path);

/// @file
/// What a GeoJSON document keeps of the layer it was read from, so that it can be written again.
typedef struct geojson_layer
{
    char *name;             ///< null for none
    char *ids;              ///< the column of the features' numbers; "" for none
    OGRFeatureDefnH fields; ///< shared with GDAL
    bool any_geometry;      ///< the layer takes geometries of all types
} geojson_layer;

// Coordinate systems.

/// The system of a name ("EPSG:25833", a URN, WKT), longitude and east first. Null, with a message of GDAL, for none.
OGRSpatialReferenceH system_by_name(const char *name);

/// The name of a system: its code, as in "EPSG:25833", else WKT. Null when out of memory.
char *system_name(OGRSpatialReferenceH system);

/// Whether the coordinates are longitude and latitude in degrees from Greenwich.
bool system_is_degrees(OGRSpatialReferenceH system);

/// Whether a layer stores the two coordinates in the reverse of the order above.
bool system_is_swapped(OGRSpatialReferenceH system);
