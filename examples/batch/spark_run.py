"""Scenes through Spark: spark-submit spark_run.py SCENES.jsonl FOLDER (text files, a line for each scene)

The command is on the path of every machine. Its exit codes 2 and 3 are lines of invalid scenes and of scenes without convergence.
"""

import os
import sys

from pyspark.sql import SparkSession

COMMAND = "implant-preview simulate - --lines --threads 1 --fields status,contact_force_n,strain.max_principal"

spark = SparkSession.builder.appName("implant-preview").getOrCreate()
lines = spark.sparkContext.textFile(sys.argv[1], minPartitions=64)
# Spark passes no environment on; the driver's path finds the command.
lines.pipe(COMMAND, env={"PATH": os.environ["PATH"]}, checkCode=False).saveAsTextFile(sys.argv[2])
spark.stop()
