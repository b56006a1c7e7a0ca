# SPDX-License-Identifier: Apache-2.0
"""Writes bag.db3 or tf.db3 with the messages of make_bags.mjs (messages.json or transforms.json), in the tables of
rosbag2: make_db3.py JSON DB3."""
import json
import pathlib
import sqlite3
import sys

messages = json.loads(pathlib.Path(sys.argv[1]).read_text())
pathlib.Path(sys.argv[2]).unlink(missing_ok=True)
bag = sqlite3.connect(sys.argv[2])
bag.execute("PRAGMA page_size=1024")
bag.execute(
    "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL,"
    " serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL)")
bag.execute(
    "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL,"
    " timestamp INTEGER NOT NULL, data BLOB NOT NULL)")
topics = {}
for message in messages:
    if message["topic"] not in topics:
        topics[message["topic"]] = len(topics) + 1
        bag.execute("INSERT INTO topics VALUES(?,?,?,'cdr','')",
                    (topics[message["topic"]], message["topic"], message["type"]))
    bag.execute("INSERT INTO messages(topic_id, timestamp, data) VALUES(?,?,?)",
                (topics[message["topic"]], int(message["ns"]) + 3000000, bytes.fromhex(message["data"])))
bag.commit()
bag.close()
