m<f:FeatureCollection xmlns:f="http://f" xmlns:gml="http://www.opengis.net/gml">
<gml:featureMember><f:road fid="road.0"><f:name>a</f:name><f:width>3.5</f:width><f:geom><gml:LineString srsName="EPSG:4326"><gml:coordinates>8,47 8.5,47.2 9,47.1</gml:coordinates></gml:LineString></f:geom></f:road></gml:featureMember>
<gml:featureMember><f:road fid="road.1"><f:name>b</f:name><f:geom><gml:Curve srsName="urn:ogc:def:crs:EPSG::4326"><aaa-suitents><gml:Arc><gml:posList>47 8 47.2 8.5 47 9</gml:posList></gml:Arc></gmst></gml:LinearRing></gml:exterior></gml:Polygon></f:geom></f:road></gml:featureMember>
</f:FeatureCollection>
